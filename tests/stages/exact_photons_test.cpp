// Photons traced exactly, against closed forms, and what their accounts say.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

stages::Settings exact(int width = 32, int height = 24, int photons = 256, int map_size = 256) {
    stages::Settings s = small(width, height, photons, map_size);
    s.tracing = stages::Tracing::Exact;
    return s;
}

int add_glass(scenes::Scene& scene, float ior, float sigma = 0) {
    scenes::Material m;
    m.name = "glass";
    m.transmission = 1;
    m.roughness = 0;
    m.ior = ior;
    m.has_volume = true;
    if (sigma > 0) m.attenuation_color = glm::vec3(std::exp(-sigma)), m.attenuation_distance = 1;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}
int add_thin_glass(scenes::Scene& scene, float ior) {
    const int m = add_glass(scene, ior);
    scene.materials.back().has_volume = false;
    return m;
}
int add_mirror(scenes::Scene& scene, const glm::vec3& color) {
    scenes::Material m;
    m.name = "mirror";
    m.base_color = color;
    m.metallic = 1;
    m.roughness = 0;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}
void add_sun(scenes::Scene& scene, const glm::vec3& direction = {0, -1, 0}) {
    scenes::Light sun;
    sun.name = "sun";
    sun.type = scenes::LightType::Directional;
    sun.direction = direction;
    scene.lights.push_back(sun);
}
void add_sheet(scenes::Scene& scene, const char* name, int material, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    scenes::Mesh m;
    m.name = name;
    m.material = material;
    m.positions = {a, b, c, d};
    m.normals.assign(4, glm::normalize(glm::cross(b - a, c - a)));
    m.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(m);
}
// A square plate about the vertical axis, seen from above or from below.
void add_level(scenes::Scene& scene, const char* name, int material, float half, float y, bool faces_up = true) {
    const glm::vec3 a(-half, y, half), b(half, y, half), c(half, y, -half), d(-half, y, -half);
    if (faces_up) add_sheet(scene, name, material, a, b, c, d);
    else add_sheet(scene, name, material, d, c, b, a);
}
void add_box(scenes::Scene& scene, const char* name, int material, const glm::vec3& low, const glm::vec3& high) {
    scenes::Mesh room = scenes::make_room(name, material, low, high);
    for (std::size_t i = 0; i < room.indices.size(); i += 3) std::swap(room.indices[i + 1], room.indices[i + 2]);
    for (glm::vec3& n : room.normals) n = -n;
    scene.meshes.push_back(room);
}
scenes::Scene floor_scene(float half = 3) {
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.7f)), half);
    add_camera_above(scene, 4, 0.9f);
    return scene;
}
double shine_through(double ior) {
    const double r = (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
    return (1 - r) / (1 + r);
}

}  // namespace

TEST_CASE("photons land where two refractions by a ball take them, with what Fresnel's formula leaves") {
    Device device;
    scenes::Scene scene = floor_scene();
    constexpr double radius = 0.5, height = 0.7, ior = 1.5;
    scene.meshes.push_back(scenes::make_sphere("ball", add_glass(scene, static_cast<float>(ior)), {0, static_cast<float>(height), 0}, static_cast<float>(radius), 6));
    add_sun(scene);
    stages::Settings settings = exact();
    settings.keep_photons = true;
    const Rendered r = render(device, scene, settings);
    REQUIRE(r.renderer->plan().maps[0].branch == stages::Branch::Refracted);
    const int side = settings.photons;
    std::vector<float> positions(static_cast<std::size_t>(side) * side * 4), fluxes(positions.size());
    r.renderer->photon_positions(0).download(positions.data());
    r.renderer->photon_fluxes(0).download(fluxes.data());
    const double half = radius * 1.01, texel = 4 * half * half / (side * side);
    int compared = 0;
    double sum = 0, expected = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const double a = ((x + 0.5) / side * 2 - 1) * half, b = ((y + 0.5) / side * 2 - 1) * half, offset = std::hypot(a, b);
            // At the rim a ball of triangles is no ball.
            if (offset > 0.95 * radius) continue;
            const double in = std::asin(offset / radius), bent = std::asin(offset / radius / ior), turned = 2 * (in - bent);
            // In the plane of incidence: out of the ball at an angle of 2 bent - in from straight down.
            const double leaves_at = 2 * bent - in, out_x = radius * std::sin(leaves_at), out_y = height - radius * std::cos(leaves_at);
            const double lands = out_x - out_y * std::tan(turned);
            const auto fresnel = [&](double from, double to) {
                const double s = std::sin(from - to) / std::sin(from + to), p = std::tan(from - to) / std::tan(from + to);
                return offset < 1e-3 ? std::pow((ior - 1) / (ior + 1), 2) : 0.5 * (s * s + p * p);
            };
            const double kept = (1 - fresnel(in, bent)) * (1 - fresnel(bent, in));
            const float *p = &positions[(static_cast<std::size_t>(y) * side + x) * 4], *f = &fluxes[(static_cast<std::size_t>(y) * side + x) * 4];
            REQUIRE(p[3] == 1);
            ++compared;
            CHECK(std::abs(p[1]) < 1e-5);
            CHECK(std::abs(std::hypot(p[0], p[2]) - std::abs(lands)) < 4e-3);
            // Each photon is corrected for how much its triangle turns towards it more than the ball does; the sum is right.
            CHECK(f[0] == doctest::Approx(texel * kept).epsilon(0.04).scale(0));
            sum += f[0];
            expected += texel * kept;
        }
    }
    CHECK(sum == doctest::Approx(expected).epsilon(5e-4).scale(0));
    CHECK(compared > 30000);
}

TEST_CASE("light goes on from one object to the next: two slabs, with all that is reflected between them") {
    Device device;
    for (const bool thin : {false, true}) {
        CAPTURE(thin);
        scenes::Scene scene = floor_scene();
        if (thin) {
            const int glass = add_thin_glass(scene, 1.7f);
            add_level(scene, "upper", glass, 0.5f, 1.5f);
            add_level(scene, "lower", glass, 0.5f, 0.5f);
        } else {
            const int glass = add_glass(scene, 1.7f);
            add_box(scene, "upper", glass, {-0.5f, 1.5f, -0.5f}, {0.5f, 1.6f, 0.5f});
            add_box(scene, "lower", glass, {-0.5f, 0.5f, -0.5f}, {0.5f, 0.6f, 0.5f});
        }
        add_sun(scene);
        stages::Settings settings = exact(32, 24, 512);
        settings.bounces = 64;
        const stages::EnergyAudit audit = render(device, scene, settings).renderer->audit();
        const double through = shine_through(1.7), back = 1 - through;
        CHECK(audit.emitted == doctest::Approx(3.0).epsilon(0.01).scale(0));
        CHECK((audit.deposited + audit.beside) / audit.emitted == doctest::Approx(through * through / (1 - back * back)).epsilon(2e-3).scale(0));
        CHECK(audit.imbalance() < 1e-4);
        // One object alone is what is seen from the light in its own picture.
        settings.tracing = stages::Tracing::ImageSpace;
        const stages::EnergyAudit alone = render(device, scene, settings).renderer->audit();
        CHECK((alone.deposited + alone.beside) / alone.emitted > 1.02 * through * through / (1 - back * back));
    }
}

TEST_CASE("a mirror's light goes through glass, and both take their share") {
    // A mirror that sends parallel light straight down, through a plate.
    Device device;
    scenes::Scene scene = floor_scene();
    const glm::vec3 sun = glm::normalize(glm::vec3(1, -0.2f, 0)), normal = glm::normalize(glm::vec3(0, -1, 0) - sun), along = glm::cross(normal, glm::vec3(0, 0, 1)) * 0.65f, across(0, 0, 0.5f), middle(0, 1.6f, 0);
    add_sheet(scene, "mirror", add_mirror(scene, {0.9f, 0.5f, 0.25f}), middle - along - across, middle + along - across, middle + along + across, middle - along + across);
    add_box(scene, "plate", add_glass(scene, 1.4f, 2.0f), {-0.6f, 0.3f, -0.6f}, {0.6f, 0.5f, 0.6f});
    add_sun(scene, sun);
    stages::Settings settings = exact();
    settings.bounces = 64;
    settings.keep_photons = true;
    const Rendered r = render(device, scene, settings);
    const stages::EnergyAudit& audit = r.renderer->audit();
    const double reflectance = std::pow(0.4 / 2.4, 2), transmittance = std::exp(-2.0 * 0.2);
    const double shining = (1 - reflectance) * (1 - reflectance) * transmittance / (1 - reflectance * reflectance * transmittance * transmittance);
    double landed = 0;
    for (std::size_t k = 0; k < r.renderer->plan().maps.size(); ++k) {
        if (r.built.world.meshes[static_cast<std::size_t>(r.renderer->plan().maps[k].mesh)].name != "mirror") continue;
        std::vector<float> fluxes(static_cast<std::size_t>(settings.photons) * settings.photons * 4);
        r.renderer->photon_fluxes(static_cast<int>(k)).download(fluxes.data());
        for (std::size_t i = 0; i < fluxes.size(); i += 4) landed += fluxes[i] / 0.9 + fluxes[i + 1] / 0.5 + fluxes[i + 2] / 0.25;
    }
    CHECK(landed == doctest::Approx(3 * 1.3 * -glm::dot(normal, sun) * shining).epsilon(0.01).scale(0));
    CHECK(audit.imbalance() < 1e-4);
}

TEST_CASE("light from inside a volume is absorbed on its way out") {
    Device device;
    scenes::Scene scene = floor_scene();
    add_box(scene, "block", add_glass(scene, 1.0f, 1.5f), {-0.5f, 0.5f, -0.5f}, {0.5f, 1.5f, 0.5f});
    scenes::Light spot;
    spot.name = "spot";
    spot.type = scenes::LightType::Spot;
    spot.position = {0, 1.2f, 0};
    spot.direction = {0, -1, 0};
    spot.intensity = glm::vec3(10);
    spot.inner_cone = 0.05f;
    spot.outer_cone = 0.06f;
    scene.lights.push_back(spot);
    const stages::EnergyAudit audit = render(device, scene, exact()).renderer->audit();
    CHECK(audit.emitted > 0);
    CHECK((audit.deposited + audit.beside) / audit.emitted == doctest::Approx(std::exp(-1.5 * 0.7)).epsilon(2e-3).scale(0));
    CHECK(audit.imbalance() < 1e-4);
}

TEST_CASE("a light inside an object, or touching it, sends photons all round") {
    Device device;
    for (const float height : {1.0f, 1.2f, 1.505f}) {
        CAPTURE(height);
        scenes::Scene scene = empty_scene();
        scene.meshes.push_back(scenes::make_room("room", add_lambert(scene, glm::vec3(0.5f)), {-2, -1, -2}, {2, 3, 2}));
        scene.meshes.push_back(scenes::make_sphere("ball", add_glass(scene, 1.5f), {0, 1, 0}, 0.5f, 5));
        add_camera_above(scene, 2.9f, 0.9f);
        add_point_light(scene, {0, height, 0}, glm::vec3(1));
        stages::Settings settings = exact(32, 24, 512);
        settings.bounces = 64;
        const stages::EnergyAudit audit = render(device, scene, settings).renderer->audit();
        // Outside it, what the ball fills of all directions.
        const double outside = height - 1.0, filled = outside < 0.5 ? 1.0 : 0.5 * (1 - std::sqrt(1 - 0.25 / (outside * outside)));
        CHECK(audit.emitted == doctest::Approx(3 * 4 * std::acos(-1.0) * filled).epsilon(0.01).scale(0));
        // Beyond the centre by more than the critical angle allows, some of the light never gets out.
        CHECK((audit.deposited + audit.beside + audit.trapped) / audit.emitted == doctest::Approx(1.0).epsilon(3e-3).scale(0));
        CHECK(audit.imbalance() < 1e-4);
    }
}

TEST_CASE("receivers stop light from behind, and are lit there only if they are seen there") {
    Device device;
    for (const bool two_sided : {false, true}) {
        for (const bool faces_up : {false, true}) {
            CAPTURE(two_sided);
            CAPTURE(faces_up);
            scenes::Scene scene = floor_scene();
            add_level(scene, "shelf", add_lambert(scene, glm::vec3(0.5f), two_sided), 1, 0.4f, faces_up);
            add_box(scene, "slab", add_glass(scene, 1.0f), {-0.5f, 0.8f, -0.5f}, {0.5f, 0.9f, 0.5f});
            add_sun(scene);
            const stages::EnergyAudit audit = render(device, scene, exact()).renderer->audit();
            const double lit = audit.deposited / audit.emitted;
            if (two_sided || faces_up) CHECK(lit > 0.999);
            else CHECK(audit.missed / audit.emitted > 0.999);
            CHECK(audit.imbalance() < 1e-4);
        }
    }
}

TEST_CASE("what lands where the light does not see lies there, and not on what it sees there") {
    // A mirror sends light under a shelf.
    Device device;
    scenes::Scene scene = floor_scene();
    add_level(scene, "shelf", add_lambert(scene, glm::vec3(0.5f), true), 1, 0.6f);
    add_sheet(scene, "mirror", add_mirror(scene, glm::vec3(1)), {1.5f, 0.05f, 0.3f}, {1.5f, 0.05f, -0.3f}, {1.8f, 0.322f, -0.3f}, {1.8f, 0.322f, 0.3f});
    add_sun(scene, glm::normalize(glm::vec3(-0.2f, -1, 0)));
    const Rendered r = render(device, scene, exact(64, 48));
    const stages::EnergyAudit& audit = r.renderer->audit();
    CHECK(audit.emitted > 0);
    CHECK(audit.deposited / audit.emitted > 0.99);
    CHECK(audit.imbalance() < 1e-4);
    // From above, the shelf's top shows none of it.
    for (int y = 14; y < 34; ++y)
        for (int x = 22; x < 42; ++x) REQUIRE(r.at(r.caustic, x, y) == glm::vec3(0));
}

TEST_CASE("a lamp in a wall's plane lights both sides, whatever rounding makes of the plane") {
    // A wall that stands on the picture's middle, in a plane through its lamp and the eye; the floor shows a / pi I cos / d^2.
    Device device;
    for (const float turn : {0.0f, 0.7f, 1.1f, 2.3f}) {
        CAPTURE(turn);
        const glm::vec3 along(std::cos(turn), 0, std::sin(turn)), across(-along.z, 0, along.x), lamp = along * 0.3f + glm::vec3(0, 1.1f, 0);
        scenes::Scene scene = floor_scene();
        add_sheet(scene, "wall", add_lambert(scene, glm::vec3(0.5f), true), -along, along, along + glm::vec3(0, 1.7f, 0), -along + glm::vec3(0, 1.7f, 0));
        add_point_light(scene, lamp, glm::vec3(3));
        const Rendered r = render(device, scene, exact(64, 48));
        const double half = std::tan(0.45) * 4;
        int compared = 0;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                const glm::dvec3 p(((x + 0.5) / 32 - 1) * half * 4 / 3, 0, ((y + 0.5) / 24 - 1) * half), d = glm::dvec3(lamp) - p;
                if (std::abs(glm::dot(p, glm::dvec3(across))) < 0.1) continue;
                const double squared = glm::dot(d, d);
                CAPTURE(x);
                CAPTURE(y);
                REQUIRE(r.at(r.direct, x, y).x == doctest::Approx(0.7 / 3.14159265358979 * 3 * d.y / std::sqrt(squared) / squared).epsilon(1e-4).scale(0));
                ++compared;
            }
        }
        CHECK(compared > 2500);
    }
}

TEST_CASE("light that grazes a triangle lights it by its vertices' normals, however much they lean") {
    Device device;
    for (const float height : {0.3f, 0.03f, 0.003f}) {
        for (const float lean : {0.5f, 0.01f, -0.001f}) {
            CAPTURE(height);
            CAPTURE(lean);
            scenes::Scene scene = floor_scene();
            const glm::vec3 normal = glm::normalize(glm::vec3(lean, 1, 0)), towards = glm::normalize(glm::vec3(1, height, 0.2f));
            for (glm::vec3& n : scene.meshes[0].normals) n = normal;
            add_sun(scene, -towards);
            const Rendered r = render(device, scene, exact(16, 12));
            for (int y = 0; y < 12; ++y)
                for (int x = 0; x < 16; ++x) REQUIRE(r.at(r.direct, x, y).x == doctest::Approx(0.7 / 3.14159265358979 * glm::dot(normal, towards)).epsilon(1e-4).scale(0));
        }
    }
}

TEST_CASE("every watt of every bundled scene is accounted for") {
    Device device;
    for (const std::string_view scene : scenes::bundled_scene_names()) {
        const std::string name(scene);
        CAPTURE(name);
        for (const bool inner : {true, false}) {
            stages::Settings settings = exact();
            settings.inner_reflections = inner;
            const stages::EnergyAudit audit = render(device, scenes::bundled_scene(scene), settings).renderer->audit();
            CHECK(audit.imbalance() < 1e-4);
            CHECK(audit.emitted >= 0);
            CHECK(audit.deposited >= 0);
            if (inner) CHECK(audit.not_followed <= 1e-6 * audit.emitted);
        }
    }
}

TEST_CASE("exact tracing needs no pictures of objects and receivers from the light, and says so") {
    Device device;
    const Rendered r = render(device, scenes::bundled_scene("sphere-above-water"), exact());
    for (const stages::Pass& pass : r.renderer->plan().passes) {
        CHECK(pass.kind != stages::PassKind::CasterLayers);
        CHECK(pass.kind != stages::PassKind::ReceiverMap);
    }
    int said = 0;
    for (const auto& left_out : r.renderer->plan().left_out) said += left_out.why == "light is followed through the triangles";
    CHECK(said == 3);
}

TEST_CASE("variants that look at pictures of objects do not go with exact tracing") {
    Device device;
    const BuiltWorld built = build_world(device, scenes::bundled_scene("glass-sphere"));
    const auto is_refused = [&](const stages::Settings& settings) { return !stages::Renderer(device, built.world, settings).faults().empty(); };
    stages::Settings settings = exact(16, 12, 256, 64);
    CHECK_FALSE(is_refused(settings));
    for (const stages::mapping::Variant variant : {stages::mapping::Variant::Tutorial, stages::mapping::Variant::Vertices}) {
        settings.variant = variant;
        CHECK(is_refused(settings));
    }
    settings.variant = stages::mapping::Variant::TwoSided;
    settings.technique = stages::Technique::Hierarchical;
    CHECK_FALSE(is_refused(settings));
    settings.hierarchical_variant = stages::hierarchical::Variant::ThinLens;
    CHECK(is_refused(settings));
}

TEST_CASE("a number of photons that is no power of two is refused") {
    Device device;
    const BuiltWorld built = build_world(device, scenes::bundled_scene("glass-sphere"));
    for (const int photons : {0, -4, 48, 3000}) {
        CAPTURE(photons);
        for (const stages::Tracing tracing : {stages::Tracing::ImageSpace, stages::Tracing::Exact}) {
            stages::Settings settings = small(16, 12, photons, 64);
            settings.tracing = tracing;
            CHECK_FALSE(stages::Renderer(device, built.world, settings).faults().empty());
        }
    }
}

}  // namespace nephroid::test
