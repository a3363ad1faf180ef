// nephroid render: a scene to a picture.
#include <cstdio>
#include <memory>

#include "scenes/load.hpp"
#include "stages/renderer.hpp"
#include "tools/commands.hpp"
#include "tools/picture_file.hpp"
#include "tools/world_builder.hpp"

namespace nephroid {

namespace {

struct RenderArguments {
    std::string scene = "glass-sphere", out;
    std::string size;
    int threads = 0, lanes = 0, samples = 1;
    int photons = 1024, map_size = 1024, iterations = 12, bounces = 8;
    std::string variant = "two-sided", intersection = "bisection";
    float sprite = 3.0f, exposure = 0.0f;
    bool layers = false, hash = false;
};

void run(const RenderArguments& a) {
    check_picture_path(a.out);
    Device device({.threads = a.threads, .lanes = a.lanes});
    const scenes::Scene scene = scenes::load_scene(a.scene);
    for (const std::string& n : scene.notes) std::fprintf(stderr, "note: %s\n", n.c_str());
    const BuiltWorld built = build_world(device, scene);
    for (const std::string& n : built.notes) std::fprintf(stderr, "note: %s\n", n.c_str());
    stages::Settings s;
    std::sscanf(a.size.c_str(), "%dx%d", &s.width, &s.height);
    s.photons = a.photons, s.map_size = a.map_size, s.iterations = a.iterations, s.bounces = a.bounces, s.samples_side = a.samples, s.sprite_size = a.sprite;
    s.variant = a.variant == "tutorial" ? stages::mapping::Variant::Tutorial : a.variant == "vertices" ? stages::mapping::Variant::Vertices : stages::mapping::Variant::TwoSided;
    s.intersection = a.intersection == "newton" ? stages::Intersection::Newton : a.intersection == "secant" ? stages::Intersection::Secant : stages::Intersection::Bisection;
    stages::Renderer renderer(device, built.world, s);
    const Faults f = renderer.render();
    char text[2000];
    if (!f.empty()) f.format(text, sizeof text), throw std::runtime_error(text);
    const stages::Picture p = renderer.picture();
    PictureData out{s.width, s.height, {"R", "G", "B"}, {}};
    if (a.layers)
        for (const char* l : {"caustic", "direct", "emission"})
            for (const char* c : {".R", ".G", ".B"}) out.channels.push_back(std::string(l) + c);
    for (int y = 0; y < s.height; ++y) {
        const float *d = reinterpret_cast<const float*>(p.direct->row(y)), *c = reinterpret_cast<const float*>(p.caustic->row(y)), *e = reinterpret_cast<const float*>(p.emission->row(y));
        for (int x = 0; x < s.width; ++x, d += 4, c += 4, e += 4) {
            for (int k = 0; k < 3; ++k) out.values.push_back((d[k] + c[k]) + e[k]);
            if (a.layers)
                for (const float* l : {c, d, e}) out.values.insert(out.values.end(), l, l + 3);
        }
    }
    const std::string hash = write_picture(a.out, out, a.exposure);
    if (a.hash) std::printf("%s\n", hash.c_str());
    const stages::EnergyAudit& e = renderer.audit();
    std::fprintf(stderr, "audit: emitted %.6g deposited %.6g absorbed %.6g not followed %.6g trapped %.6g missed %.6g beside %.6g correction %.6g imbalance %.2e\n", e.emitted, e.deposited, e.absorbed,
                 e.not_followed, e.trapped, e.missed, e.beside, e.correction, e.imbalance());
    for (std::size_t k = 0; k < renderer.records().size(); ++k) std::fprintf(stderr, "%9.2f ms  %s\n", renderer.records()[k].milliseconds, renderer.plan().passes[k].name.c_str());
}

}  // namespace

void add_render_command(CLI::App& app) {
    const auto a = std::make_shared<RenderArguments>();
    CLI::App* c = app.add_subcommand("render", "Render a scene to a picture");
    c->add_option("scene", a->scene);
    c->add_option("-o,--output", a->out)->required();
    c->add_option("--size", a->size);
    c->add_option("--threads", a->threads);
    c->add_option("--lanes", a->lanes);
    c->add_option("--samples", a->samples);
    c->add_option("--photons", a->photons);
    c->add_option("--map-size", a->map_size);
    c->add_option("--iterations", a->iterations);
    c->add_option("--bounces", a->bounces);
    c->add_option("--variant", a->variant);
    c->add_option("--intersection", a->intersection);
    c->add_option("--sprite", a->sprite);
    c->add_option("--exposure", a->exposure);
    c->add_flag("--layers", a->layers);
    c->add_flag("--hash", a->hash);
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
