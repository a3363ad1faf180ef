// Geometric optics at a smooth surface, on lanes.
#pragma once
#include <glm/geometric.hpp>

#include "pipeline/lanes.hpp"

namespace nephroid::stages {

// The mirror direction of a direction of travel `d` at normal `n`, both of unit length.
template <class F>
inline vec3<F> reflect(const vec3<F>& d, const vec3<F>& n) {
    return d - n * (F(2.0f) * glm::dot(d, n));
}

// Snell's law. `d` is the direction of travel and `n` the normal on the side it comes from (d . n <= 0), both of unit
// length; `eta` is n_from / n_to. Where all is reflected, `total` is set and the direction is meaningless.
template <class F>
struct Refraction {
    vec3<F> direction;  // unit length
    F cos_from, cos_to;
    LaneMask<F> total;
};
template <class F>
inline Refraction<F> refract(const vec3<F>& d, const vec3<F>& n, F eta) {
    Refraction<F> r;
    r.cos_from = min(max(-glm::dot(d, n), F(0.0f)), F(1.0f));
    const F k = F(1.0f) - eta * eta * (F(1.0f) - r.cos_from * r.cos_from);
    r.total = k < F(0.0f);
    r.cos_to = sqrt(max(k, F(0.0f)));
    r.direction = glm::normalize(d * eta + n * (eta * r.cos_from - r.cos_to));
    return r;
}

// Fresnel's reflectance for unpolarised light, from the two cosines and eta = n_from / n_to. Both cosines are 0 only where
// light grazes a surface between equal media, which reflects nothing.
template <class F>
inline F fresnel(F cos_from, F cos_to, F eta) {
    const F least(1e-20f);
    const F s = (eta * cos_from - cos_to) / max(eta * cos_from + cos_to, least), p = (cos_from - eta * cos_to) / max(cos_from + eta * cos_to, least);
    return F(0.5f) * (s * s + p * p);
}
template <class F>
inline F fresnel(const Refraction<F>& r, F eta) {
    return select(r.total, F(1.0f), fresnel(r.cos_from, r.cos_to, eta));
}

// What is transmitted by a plate between two equal media, all reflections inside it counted: (1 - R) / (1 + R).
template <class F>
inline F thin_plate_transmittance(F reflectance) {
    return (F(1.0f) - reflectance) / (F(1.0f) + reflectance);
}

// Veach's correction for light that meets interpolated normals: the ratio that keeps a path's radiance the same whichever
// end it is followed from (Veach 1997, section 5.3). Cosines of arrival and departure with the shading normal n and the
// geometric one g, all absolute values.
template <class F>
inline F adjoint_factor(F arrive_n, F depart_n, F arrive_g, F depart_g) {
    const F denominator = arrive_g * depart_n;
    return select(denominator > F(1e-6f), arrive_n * depart_g / max(denominator, F(1e-6f)), F(1.0f));
}

}  // namespace nephroid::stages
