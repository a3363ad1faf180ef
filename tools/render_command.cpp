// nephroid render: a scene to a picture.
#include <chrono>
#include <cstdio>
#include <memory>

#include "pipeline/math.hpp"
#include "tools/chart/auto_settings.hpp"
#include "tools/commands.hpp"
#include "tools/debug_pixel.hpp"
#include "tools/failure_zones.hpp"
#include "tools/frame_statistics.hpp"
#include "tools/number_range.hpp"
#include "tools/picture_file.hpp"
#include "tools/progress.hpp"
#include "tools/render_options.hpp"
#include "tools/scene_renderer.hpp"
#include "tools/throw_faults.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct RenderArguments {
    RenderOptions options;
    chart::AutoRequest request;
    std::string out, stats, frames, debug_pixel;
    float orbit_light = 0, orbit_camera = 0, exposure = 0;
    int runs = 1;
    bool layers = false, hash = false, keep_idle = false;
};

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// "A:B", or nothing for a single picture.
bool parse_frames(const std::string& text, int& first, int& last) {
    if (text.empty()) return false;
    char rest = 0;
    constexpr int most = 999999;
    if (std::sscanf(text.c_str(), "%7d:%7d%c", &first, &last, &rest) != 2 || first < 0 || last < first || last > most)
        throw std::runtime_error("--frames: '" + text + "' is not FIRST:LAST, two numbers from 0 to " + std::to_string(most));
    return true;
}

// The frame's number in place of the #s of a name, or before its ending.
std::string frame_name(const std::string& name, int frame) {
    std::size_t first = name.find('#'), count = 0;
    if (first == std::string::npos) first = name.find_last_of('.'), count = 0;
    else while (first + count < name.size() && name[first + count] == '#') ++count;
    char number[16];
    std::snprintf(number, sizeof number, "%0*d", static_cast<int>(count == 0 ? 4 : count), frame);
    std::string numbered = name.substr(0, first);
    numbered += number;
    numbered += name.substr(first + count);
    return numbered;
}

// Turned about the vertical axis through `centre`.
glm::vec3 turned(const glm::vec3& v, float angle) {
    const float c = cos(angle), s = sin(angle);
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}
void place_frame(const stages::World& base, stages::World& world, int frame, float light_degrees, float camera_degrees) {
    const glm::vec3 centre = (base.low + base.high) * 0.5f;
    const float to_radians = 0.0174532925f, light = light_degrees * to_radians * static_cast<float>(frame), camera = camera_degrees * to_radians * static_cast<float>(frame);
    for (std::size_t l = 0; l < world.lights.size(); ++l) {
        world.lights[l].position = centre + turned(base.lights[l].position - centre, light);
        world.lights[l].direction = turned(base.lights[l].direction, light);
    }
    world.camera.position = centre + turned(base.camera.position - centre, camera);
    world.camera.right = turned(base.camera.right, camera);
    world.camera.up = turned(base.camera.up, camera);
    world.camera.forward = turned(base.camera.forward, camera);
}

// "X,Y", or nothing: -1.
glm::ivec2 parse_pixel(const std::string& text) {
    glm::ivec2 pixel{-1};
    char rest = 0;
    if (!text.empty() && (std::sscanf(text.c_str(), "%8d,%8d%c", &pixel.x, &pixel.y, &rest) != 2 || pixel.x < 0 || pixel.y < 0))
        throw std::runtime_error("--debug-pixel: '" + text + "' is not COLUMN,ROW");
    return pixel;
}

// What --technique auto picks is not given as well.
void check_request(const RenderArguments& a, const CLI::App& command) {
    if (a.request.error == 0 && a.request.budget == 0) return;
    const char* asked = a.request.error > 0 ? "--error" : "--budget";
    if (a.options.technique != "auto") throw std::runtime_error(std::string(asked) + ": needs --technique auto");
    for (const char* picked : {"--variant", "--tracing", "--intersection", "--iterations", "--photons", "--map-size", "--splat-size", "--splat-threshold", "--splat-form", "--discard-wide-splats", "--bounces", "--inner-reflections", "--depth-layers"})
        if (command.count(picked)) throw std::runtime_error(std::string(asked) + ": --technique auto picks " + picked + ", which is given as well");
}

// Before anything is loaded or rendered: what is asked for can be written.
void check_outputs(const RenderArguments& a) {
    check_picture_path(a.out);
    const std::string ending = picture_ending(a.out);
    if (a.layers && (ending == ".png" || ending == ".hdr")) throw std::runtime_error("--layers: " + a.out + " has no room for them; EXR and TIFF have");
    if (a.exposure != 0.0f && ending != ".png") throw std::runtime_error("--exposure: " + a.out + " holds radiance as it is; only a PNG is exposed");
    if (a.stats.empty()) return;
    check_file_path(a.stats);
    if (a.stats == a.out) throw std::runtime_error(a.out + ": the picture and its statistics cannot be one file");
}

void run(RenderArguments& a) {
    int first_frame = 0, last_frame = 0;
    const bool numbered = parse_frames(a.frames, first_frame, last_frame);
    const glm::ivec2 debug = parse_pixel(a.debug_pixel);
    check_outputs(a);

    FrameTimes times;
    const double load_start = now_ms();
    Device device({.threads = a.options.threads, .lanes = a.options.lanes});
    throw_faults(device.faults());
    const scenes::Scene scene = load_scene(a.options);
    a.options.finish(scene);
    a.options.settings.leave_out = !a.keep_idle;
    if (debug.x >= a.options.settings.width || debug.y >= a.options.settings.height) throw std::runtime_error("--debug-pixel: lies outside the picture");
    say_notes(scene.notes);
    BuiltWorld built = build_world(device, scene);
    say_notes(built.notes);
    const std::vector<stages::Light> lights = built.world.lights;
    const stages::Camera camera = built.world.camera;
    times.load_ms = now_ms() - load_start;

    std::shared_ptr<stages::TracedWorld> traced;
    if (a.request.error > 0 || a.request.budget > 0) {
        // What is traced is needed anyway, and made once.
        const double prepare_start = now_ms();
        traced = chart::trace_world(device, built.world);
        times.prepare_ms = now_ms() - prepare_start;
        const chart::AutoChoice choice = chart::choose_settings(device, built.world, traced, scene, a.request, a.options);
        times.probe_ms = choice.probe_ms;
        std::fprintf(stderr, "nephroid: auto picks %s: %s\n", choice.options.c_str(), choice.why.c_str());
    }
    say_notes(failure_notes(built.world, a.options.settings));
    const double prepare_start = now_ms();
    stages::Renderer renderer(device, built.world, a.options.settings, traced);
    throw_faults(renderer.faults());
    times.prepare_ms += now_ms() - prepare_start;
    Progress progress;
    std::string progress_prefix;
    renderer.listen(&progress);
    DebugPixel observer(debug * a.options.settings.samples_side);
    if (debug.x >= 0) renderer.observe(&observer);

    stages::World base;  // lights and camera as loaded
    base.lights = lights;
    base.camera = camera;
    base.low = built.world.low;
    base.high = built.world.high;
    std::string hash;
    for (int frame = first_frame; frame <= last_frame; ++frame) {
        if (numbered) {
            place_frame(base, built.world, frame, a.orbit_light, a.orbit_camera);
            progress_prefix = "frame " + std::to_string(frame) + " of " + std::to_string(first_frame) + " to " + std::to_string(last_frame);
            progress.set_prefix(progress_prefix.c_str());
        }
        for (int r = 0; r < a.runs; ++r) {
            const double start = now_ms();
            throw_faults(renderer.render());
            times.render_ms.push_back(now_ms() - start + (times.render_ms.empty() ? times.probe_ms + times.prepare_ms : 0));
        }
        const double write_start = now_ms();
        hash = write_picture(numbered ? frame_name(a.out, frame) : a.out, picture_of(renderer.picture(), a.layers), a.exposure);
        times.write_ms += now_ms() - write_start;
        if (a.hash) std::printf("%s\n", hash.c_str());
    }
    if (!a.stats.empty()) write_whole_file(a.stats, statistics_json(a.options, device, renderer, times, hash));
}

}  // namespace

void add_render_command(CLI::App& app) {
    const auto a = std::make_shared<RenderArguments>();
    CLI::App* c = app.add_subcommand("render", "Render a scene to a picture");
    a->options.add_to(*c);
    c->add_option("--error", a->request.error, "--technique auto: pick what is expected to meet this relMSE over the picture")->check(number_in(1e-6, 1e6));
    c->add_option("--budget", a->request.budget, "--technique auto: pick what is expected to come closest within so many ms")->check(number_in(0.001, 1e9))->type_name("MS");
    c->add_option("-o,--output", a->out, "The picture: .exr, .png, .tif or .hdr")->required()->type_name("FILE");
    c->add_flag("--layers", a->layers, "EXR and TIFF: each term of the picture apart, too (caustic.R ..., direct.R ..., emission.R ...)");
    c->add_option("--exposure", a->exposure, "PNG: brighter by this many stops")->check(number_in(-64, 64))->capture_default_str();
    c->add_flag("--hash", a->hash, "Print the SHA-1 of the picture's pixels");
    c->add_option("--stats", a->stats, "Write times, memory, statistics and the energy audit as JSON")->type_name("FILE");
    c->add_option("--runs", a->runs, "Render so often; times are medians")->check(CLI::Range(1, 10000))->capture_default_str();
    c->add_option("--frames", a->frames, "Render frames FIRST to LAST; #s in the output's name become the number, which else stands before the ending")->type_name("FIRST:LAST");
    c->add_option("--orbit-light", a->orbit_light, "Degrees that the lights turn about the vertical axis per frame")->check(number_in(-360, 360))->capture_default_str();
    c->add_option("--orbit-camera", a->orbit_camera, "Degrees that the camera turns about the vertical axis per frame")->check(number_in(-360, 360))->capture_default_str();
    c->add_option("--debug-pixel", a->debug_pixel, "Run on one thread and lane, and call nephroid_debug_pixel() before every pixel-stage invocation there")->type_name("COLUMN,ROW");
    c->add_flag("--keep-idle-passes", a->keep_idle, "Run passes that the plan would leave out; the picture is the same");
    c->callback([a, c] {
        check_request(*a, *c);
        run(*a);
    });
}

}  // namespace nephroid
