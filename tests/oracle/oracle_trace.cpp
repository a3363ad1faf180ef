// The oracle as a program: a scene's caustic layer, and others on request, to a picture file, its totals as JSON to standard output.
#include <OpenImageIO/imageio.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "oracle/oracle.hpp"
#include "scenes/load.hpp"

namespace {

using namespace nephroid;
using nlohmann::ordered_json;

constexpr const char* usage =
    "usage: oracle_trace SCENE [options]\n"
    "  --photons N           over all lights (1000000; 2e7 is understood)\n"
    "  --batches N           independent repetitions for the errors (32)\n"
    "  --seed N              (1)\n"
    "  --size WxH            (512x384)\n"
    "  --max-events N        (32)\n"
    "  --split N             events that follow both branches (1)\n"
    "  --spot MESH           measures the spot on that receiver\n"
    "  --flat-normals        the triangles' own normals\n"
    "  --no-correction       no adjoint correction for interpolated normals\n"
    "  --no-dispersion, --no-media, --no-view-attenuation\n"
    "  --direct              light straight from lamps too\n"
    "  --scattering          light that media scatter once too\n"
    "  --near-eye METRES     nearer than that scattered light straight from lamps is looked for from the eye (1)\n"
    "  --environment FILE    a lat-long picture of the surroundings, EXR or HDR, whose light the caustic holds too\n"
    "  --medium FILE         media, JSON, instead of the scene's\n"
    "  --threads N           (one per core)\n"
    "  -o FILE               the caustic layer: R, G, B, mask, and standard errors R.error, G.error, B.error;\n"
    "                        on request the same of direct.R ..., scattered_direct.R ..., scattered_caustic.R ...\n"
    "  --stats FILE          the totals to a file instead of standard output\n";

struct Arguments {
    std::string scene, output, stats, environment, medium;
    oracle::Options options;
};

double to_number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= 0.0 && value < 1e18)) {
        throw std::invalid_argument("not a number: " + std::string(text));
    }
    return value;
}

Arguments parse(const std::vector<std::string>& words) {
    Arguments arguments;
    oracle::Options& options = arguments.options;
    for (std::size_t k = 0; k < words.size(); ++k) {
        const std::string& word = words[k];
        const auto value = [&]() -> const std::string& {
            if (k + 1 == words.size()) throw std::invalid_argument(word + " needs a value");
            return words[++k];
        };
        const auto integer = [&] { return static_cast<int>(std::min(to_number(value()), 1e9)); };
        if (word == "--photons") options.photons = static_cast<std::uint64_t>(to_number(value()));
        else if (word == "--batches") options.batches = integer();
        else if (word == "--seed") options.seed = static_cast<std::uint64_t>(to_number(value()));
        else if (word == "--max-events") options.max_events = integer();
        else if (word == "--split") options.split_events = integer();
        else if (word == "--spot") options.spot_mesh = value();
        else if (word == "--threads") options.threads = integer();
        else if (word == "--flat-normals") options.interpolate_normals = false;
        else if (word == "--no-correction") options.adjoint_correction = false;
        else if (word == "--no-dispersion") options.dispersion = false;
        else if (word == "--no-media") options.media = false;
        else if (word == "--no-view-attenuation") options.attenuate_view = false;
        else if (word == "--direct") options.direct = true;
        else if (word == "--scattering") options.scattering = true;
        else if (word == "--near-eye") options.near_eye = to_number(value());
        else if (word == "--environment") arguments.environment = value();
        else if (word == "--medium") arguments.medium = value();
        else if (word == "-o") arguments.output = value();
        else if (word == "--stats") arguments.stats = value();
        else if (word == "--size") {
            const std::string& size = value();
            const std::size_t cross = size.find('x');
            if (cross == std::string::npos) throw std::invalid_argument("--size wants WxH");
            options.width = static_cast<int>(std::min(to_number(size.substr(0, cross)), 1e5));
            options.height = static_cast<int>(std::min(to_number(size.substr(cross + 1)), 1e5));
        } else if (arguments.scene.empty() && !word.starts_with('-')) arguments.scene = word;
        else throw std::invalid_argument("unknown argument " + word);
    }
    if (arguments.scene.empty()) throw std::invalid_argument("which scene?");
    options.environment = !arguments.environment.empty();
    return arguments;
}

ordered_json to_json(const oracle::Vec3& v) { return {v.x, v.y, v.z}; }
ordered_json to_json(const oracle::Estimate& e) { return {{"value", to_json(e.value)}, {"error", to_json(e.error)}}; }
ordered_json to_json(const oracle::SpotReport& report) {
    const oracle::Spot &s = report.spot, &e = report.error;
    return {{"flux", s.flux},           {"flux_error", e.flux},           {"centroid", to_json(s.centroid)}, {"centroid_error", to_json(e.centroid)},
            {"radius_25", s.radius_25}, {"radius_25_error", e.radius_25}, {"radius_50", s.radius_50},        {"radius_50_error", e.radius_50},
            {"radius_90", s.radius_90}, {"radius_90_error", e.radius_90}};
}

std::array<std::pair<const char*, const oracle::Layer*>, 3> layers_of(const oracle::Result& result) {
    return {{{"direct", &result.direct}, {"scattered_direct", &result.scattered_direct}, {"scattered_caustic", &result.scattered_caustic}}};
}

ordered_json to_json(const oracle::Result& result, const scenes::Scene& scene, const Arguments& arguments, double seconds) {
    ordered_json json;
    json["scene"] = arguments.scene;
    json["width"] = result.width;
    json["height"] = result.height;
    json["photons"] = result.photons;
    json["batches"] = result.batches;
    json["seed"] = arguments.options.seed;
    json["seconds"] = seconds;
    std::size_t masked = 0;
    for (const std::uint8_t value : result.mask) masked += value;
    json["masked_pixels"] = masked;
    json["picture"] = to_json(result.picture);
    json["emitted"] = to_json(result.emitted);
    json["deposited"] = to_json(result.deposited);
    json["absorbed"] = to_json(result.absorbed);
    json["escaped"] = to_json(result.escaped);
    json["truncated"] = to_json(result.truncated);
    json["correction"] = to_json(result.correction);
    for (const auto& [name, layer] : layers_of(result)) {
        if (layer->image.empty()) continue;
        json[name]["picture"] = to_json(layer->picture);
        json[name]["flux"] = to_json(layer->flux);
    }
    // Meshes may share a name; their order tells them apart.
    json["receivers"] = ordered_json::array();
    for (std::size_t m = 0; m < result.receivers.size(); ++m) {
        if (scene.materials[static_cast<std::size_t>(scene.meshes[m].material)].kind() != scenes::SurfaceKind::Lambert) continue;
        ordered_json receiver{{"mesh", scene.meshes[m].name}};
        receiver.update(to_json(result.receivers[m]));
        json["receivers"].push_back(receiver);
    }
    for (std::size_t k = 0; k < oracle::path_class_count; ++k) {
        ordered_json& entry = json["classes"][oracle::name_of(static_cast<oracle::PathClass>(k))];
        entry["picture"] = to_json(result.classes[k].picture);
        entry["deposited"] = to_json(result.classes[k].deposited);
        const double all = sum(result.picture.value);
        entry["picture_share"] = all > 0.0 ? sum(result.classes[k].picture.value) / all : 0.0;
    }
    if (!arguments.options.spot_mesh.empty()) {
        json["spot"]["mesh"] = arguments.options.spot_mesh;
        json["spot"]["all"] = to_json(result.spot_all);
        json["spot"]["transmitted_only"] = to_json(result.spot_transmitted);
        json["spot"]["first_reflected"] = to_json(result.spot_reflected);
    }
    return json;
}

void write_image(const oracle::Result& result, const std::string& path) {
    std::vector<std::string> names{"R", "G", "B", "mask", "R.error", "G.error", "B.error"};
    std::vector<const oracle::Layer*> layers;
    for (const auto& [name, layer] : layers_of(result)) {
        if (layer->image.empty()) continue;
        layers.push_back(layer);
        for (const char* channel : {".R", ".G", ".B", ".R.error", ".G.error", ".B.error"}) names.push_back(std::string(name) + channel);
    }
    std::vector<float> pixels;
    pixels.reserve(names.size() * result.mask.size());
    for (std::size_t k = 0; k < result.mask.size(); ++k) {
        const auto add = [&](const std::vector<double>& image) {
            for (std::size_t c = 0; c < 3; ++c) pixels.push_back(static_cast<float>(image[3 * k + c]));
        };
        add(result.image);
        pixels.push_back(result.mask[k]);
        add(result.image_error);
        for (const oracle::Layer* layer : layers) add(layer->image), add(layer->image_error);
    }
    OIIO::ImageSpec spec(result.width, result.height, static_cast<int>(names.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = names;
    const auto file = OIIO::ImageOutput::create(path);
    if (!file || !file->open(path, spec) || !file->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) || !file->close()) {
        throw std::runtime_error("cannot write " + path + ": " + (file ? file->geterror() : OIIO::geterror()));
    }
}

void write_text(const std::string& text, const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (file == nullptr) throw std::runtime_error("cannot write " + path);
    const bool is_written = std::fputs(text.c_str(), file) >= 0;
    if (std::fclose(file) != 0 || !is_written) throw std::runtime_error("cannot write " + path);
}

}  // namespace

int main(int count, char** words) {
    try {
        if (count < 2) {
            std::fputs(usage, stderr);
            return 2;
        }
        const Arguments arguments = parse({words + 1, words + count});
        scenes::Scene scene = scenes::load_scene(arguments.scene);
        if (!arguments.environment.empty()) scene.environment = scenes::load_environment(arguments.environment);
        if (!arguments.medium.empty()) scenes::set_media(scene, arguments.medium);
        const auto begin = std::chrono::steady_clock::now();
        const oracle::Result result = oracle::trace(scene, arguments.options);
        const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - begin;
        const std::string text = to_json(result, scene, arguments, duration.count()).dump(1) + "\n";
        if (!arguments.output.empty()) write_image(result, arguments.output);
        if (arguments.stats.empty()) std::fputs(text.c_str(), stdout);
        else write_text(text, arguments.stats);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "oracle_trace: %s\n", error.what());
        return 2;
    }
}
