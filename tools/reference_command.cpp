// nephroid reference: the truth of a scene's picture.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "tools/commands.hpp"
#include "tools/number_range.hpp"
#include "tools/picture_file.hpp"
#include "tools/printf_text.hpp"
#include "tools/progress.hpp"
#include "tools/reference/reference.hpp"
#include "tools/scene_options.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct ReferenceArguments {
    SceneOptions scene;
    std::string out, photons, resume;
    reference::Options options;
    reference::Limits limits;
    bool errors = false;
};

// "100000000", "1e8" or "8192^2".
std::uint64_t parse_photons(const std::string& text) {
    long long number = 0;
    const std::size_t caret = text.find('^');
    double value = 0;
    if (caret != std::string::npos && text.substr(caret) == "^2" && parse_whole_number(text.substr(0, caret), number)) value = static_cast<double>(number) * static_cast<double>(number);
    else if (!CLI::detail::lexical_cast(text, value)) value = 0;
    if (!(value >= 1 && value <= 1e15)) throw std::runtime_error("--photons: '" + text + "' is not a number from 1 to 1e15, nor a number^2");
    return static_cast<std::uint64_t>(value);
}

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw std::runtime_error(path + ": cannot be read");
    return bytes;
}

void run(ReferenceArguments& a) {
    check_picture_path(a.out);
    const std::string ending = picture_ending(a.out);
    if (!a.photons.empty()) a.limits.photons = parse_photons(a.photons);
    if (!a.resume.empty()) check_file_path(a.resume);
    if (a.limits.photons == 0 && a.limits.seconds == 0 && a.limits.noise == 0) a.limits.noise = 1e-3;
    const scenes::Scene scene = load_scene(a.scene);
    a.scene.picture_size(scene, a.options.width, a.options.height);
    say_notes(scene.notes);
    reference::Tracer tracer(scene, a.options);
    say_notes(tracer.notes());
    if (!a.resume.empty() && std::filesystem::exists(a.resume)) {
        try {
            tracer.resume(bytes_of(a.resume));
        } catch (const std::exception& e) {
            throw std::runtime_error(a.resume + ": " + e.what());
        }
    }
    Progress progress;
    tracer.run(a.limits, [&](double share) { progress.show(share, printf_text("%.3g photons", static_cast<double>(tracer.photons()))); });
    progress.clear();

    PictureData picture = tracer.picture();
    if (a.errors) append_channels(picture, tracer.error());
    picture.metadata = tracer.metadata();
    if (ending == ".png" || ending == ".hdr") std::fprintf(stderr, "nephroid: %s holds the picture alone; EXR and TIFF have its terms and the mask, too\n", a.out.c_str());
    write_picture(a.out, picture);
    if (!a.resume.empty()) write_whole_file(a.resume, tracer.state());
    std::printf("%.4g photons in %d passes; relMSE left by noise: %.3g, in caustic pixels %.3g\n", static_cast<double>(tracer.photons()), tracer.passes(), tracer.noise(), tracer.caustic_noise());
}

}  // namespace

void add_reference_command(CLI::App& app) {
    const auto a = std::make_shared<ReferenceArguments>();
    CLI::App* c = app.add_subcommand("reference", "Trace a scene's true picture: light over exact geometry, converged as far as asked (default: --noise 1e-3)");
    a->scene.add_to(*c);
    c->add_option("-o,--output", a->out, "The picture: .exr or .tif for the terms and the mask, too; .png, .hdr")->required()->type_name("FILE");
    c->add_option("--photons", a->photons, "Stop after so many, counted with those that are resumed: N, 1e8, N^2")->type_name("N");
    c->add_option("--time", a->limits.seconds, "Stop after so many seconds")->check(number_in(0, 1e9))->type_name("SECONDS");
    c->add_option("--noise", a->limits.noise, "Stop when the estimated relMSE of the picture is so small")->check(number_in(1e-12, 1e6))->type_name("RELMSE");
    c->add_option("--resume", a->resume, "Go on from this file if there is one; it is written at the end")->type_name("FILE");
    c->add_flag("--errors", a->errors, "Standard errors as channels R.error, G.error, B.error");
    c->add_option("--bounces", a->options.max_events, "Surfaces that light meets on its way, at most")->check(CLI::Range(1, 1024))->capture_default_str();
    c->add_option("--seed", a->options.seed, "Of the random numbers")->capture_default_str();
    c->add_option("--threads", a->options.threads, "0: one per core")->check(CLI::Range(0, 1024))->capture_default_str();
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
