// Lamps: what they send in a direction.
#pragma once
#include <limits>
#include <vector>

#include "scenes/scene.hpp"
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

// KHR_lights_punctual's range: what is left of the light after so many metres, the inverse square aside.
double range_window(double distance, double range);

// A scene's lamp, about the geometry's origin.
struct Lamp {
    Lamp(const scenes::Light& light, const Vec& origin);

    scenes::LightType type;
    Vec position, direction;
    Rgb intensity;  // W/sr; directional: W/m^2
    double cos_inner, cos_outer, range;

    bool is_dark() const { return !(intensity.x + intensity.y + intensity.z > 0); }
    // KHR_lights_punctual's cone, by the cosine of the angle from its axis; a step where the cones meet.
    double falloff(double cosine) const;

    struct Arrival {
        Vec towards;       // unit, from the point to the lamp
        double distance;   // m; infinite
        Rgb irradiance;    // across the direction, W/m^2, with the window
    };
    Arrival arrival(const Vec& point) const;
};

}  // namespace nephroid::reference
