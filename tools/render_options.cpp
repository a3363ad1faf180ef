#include "tools/render_options.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "pipeline/texture.hpp"
#include "tools/joined.hpp"
#include "tools/number_range.hpp"

namespace nephroid {

namespace {

struct NamedMappingVariant {
    const char* name;
    stages::mapping::Variant variant;
};
constexpr NamedMappingVariant mapping_variants[] = {
    {"two-sided", stages::mapping::Variant::TwoSided}, {"tutorial", stages::mapping::Variant::Tutorial}, {"vertices", stages::mapping::Variant::Vertices}};
std::vector<std::string> names_of(const auto& variants) {
    std::vector<std::string> names;
    for (const auto& v : variants) names.push_back(v.name);
    return names;
}
bool contains(const std::vector<std::string>& names, const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); }
std::vector<std::string> all_variants() {
    std::vector<std::string> names = names_of(mapping_variants);
    for (const std::string& name : names_of(stages::hierarchical::named_variants)) names.push_back(name);
    return names;
}

// "1024^2" or "1048576": photons; the edge of the smallest square of a power of two that holds as many.
int parse_photons(const std::string& text) {
    long long count = 0, edge = 0;
    const std::size_t caret = text.find('^');
    if (caret != std::string::npos ? !(parse_whole_number(text.substr(0, caret), edge) && text.substr(caret) == "^2" && edge <= 65536) : !parse_whole_number(text, count))
        throw std::runtime_error("--photons: '" + text + "' is neither a number nor a number^2");
    if (caret != std::string::npos) count = edge * edge;
    constexpr long long least = 16, most = 4096;
    if (count < least * least || count > most * most) throw std::runtime_error("--photons: must be between 16^2 and 4096^2, got " + text);
    int side = 16;
    while (static_cast<long long>(side) * side < count) side *= 2;
    return side;
}

// A photon's place and flux; in image space a texel of every layer of its object, else what it meets first; lists and a pyramid
// to find it by. However many lights there are.
double bytes_per_photon(const stages::Settings& s) {
    double bytes = 32;
    if (s.tracing == stages::Tracing::ImageSpace) bytes += 40 * (s.solid_layers + 1) + 4;
    else if (s.photons <= stages::most_remembered) bytes += 16;
    if (s.technique == stages::Technique::Hierarchical && stages::hierarchical::traverses(s.hierarchical_variant)) bytes += stages::hierarchical::merges(s.hierarchical_variant) ? 24 : 12;
    return bytes;
}

// A system that runs out of memory ends the program, or another one, without a word.
void check_memory(const scenes::Scene& scene, const stages::Settings& s) {
    const bool specular = std::any_of(scene.materials.begin(), scene.materials.end(), [](const scenes::Material& m) { return m.kind() != scenes::SurfaceKind::Lambert; });
    // Measured: what a sample's terms, positions and, behind something specular, its depth layers take; what a texel of a map
    // takes, its levels, receivers and the wide map's share included.
    const double bytes_per_sample = specular ? 200 : 100, bytes_per_texel = 196;
    const int width = s.width * s.samples_side, height = s.height * s.samples_side;
    const double samples = static_cast<double>(width) * height * bytes_per_sample;
    const double photons = specular ? static_cast<double>(s.photons) * s.photons * bytes_per_photon(s) : 0, texels = specular ? static_cast<double>(s.map_size) * s.map_size * bytes_per_texel : 0;
    const double needed = samples + photons + texels, there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (needed <= there) return;
    // The option that asks for most of it.
    const std::string what = samples >= std::max(photons, texels) ? "--size: " + std::to_string(width) + " x " + std::to_string(height) + " samples"
                             : photons >= texels                  ? "--photons: " + std::to_string(s.photons) + "^2 photons"
                                                                  : "--map-size: " + std::to_string(s.map_size) + "^2 texels";
    constexpr double gib = 1073741824.0;
    throw std::runtime_error(what + " need some " + std::to_string(std::lround(needed / gib)) + " GiB of memory, and there are " + std::to_string(std::lround(there / gib)));
}

}  // namespace

void RenderOptions::add_to(CLI::App& c) {
    SceneOptions::add_to(c);
    c.add_option("--technique", technique, "How caustics are made: auto, mapping or hierarchical (default, unless --variant is one of mapping's)")->check(CLI::IsMember({"auto", "mapping", "hierarchical"}));
    c.add_option("--variant", variant,
                 "mapping: two-sided refraction (default); the tutorial's single one; photons from the object's vertices. hierarchical: " + joined(names_of(stages::hierarchical::named_variants)) + " (default)")
        ->check(CLI::IsMember(all_variants()));
    c.add_option("--tracing", tracing, "How light is followed: through the triangles, any objects one after the other (default); through pictures from the light, one object (default with options that only image space has)")->check(CLI::IsMember({"image-space", "exact"}));
    c.add_option("--intersection", intersection, "Image space: how a ray is met with what a light sees")->check(CLI::IsMember({"bisection", "newton", "secant"}))->capture_default_str();
    c.add_option("--iterations", settings.iterations, "Of the intersection")->check(CLI::Range(1, 64))->capture_default_str();
    c.add_option("--photons", photons, "Per light and specular object: N^2 or a number, rounded up to the square of a power of two")->capture_default_str();
    c.add_option("--map-size", settings.map_size, "Texels along an edge of a caustic map")->check(CLI::Range(16, 8192))->capture_default_str();
    c.add_option("--splat-threshold", settings.splat_threshold, "varying: from twice so many texels on a splat goes to a coarser level of the map")->check(number_in(2, 64))->capture_default_str();
    c.add_option("--splat-form", splat_form, "varying, varying-single, interpolated: splats as wide along each axis of the map as neighbours are apart, as wide as the farther neighbour is away, or as the area between neighbours asks for")
        ->check(CLI::IsMember({"extents", "max-distance", "area"}))->capture_default_str();
    c.add_flag("--discard-wide-splats", settings.discard_wide_splats, "varying, varying-single: leave out what is too wide for the map's coarsest level");
    c.add_option("--splat-size", settings.sprite_size, "Texels across a photon's splat; 0: as large as the photons' spacing, or the variant, asks for")->check(number_in(0, 64))->capture_default_str();
    c.add_option("--bounces", settings.bounces, "Specular surfaces that light meets, at most; 0: 32, in image space 16")->check(CLI::Range(0, 64))->capture_default_str();
    c.add_flag("--inner-reflections,!--no-inner-reflections", settings.inner_reflections, "Follow what surfaces reflect in part inside objects (default), or leave it out");
    c.add_option("--depth-layers", settings.solid_layers, "Image space: times that a ray may enter an object")->check(CLI::Range(1, stages::max_solid_layers))->capture_default_str();
    c.add_option("--samples", samples, "Per pixel, rounded up to a square; a pixel is their mean")->check(CLI::Range(1, 256))->capture_default_str();
    c.add_option("--threads", threads, "0: one per core")->check(CLI::Range(0, 1024))->capture_default_str();
    c.add_option("--lanes", lanes, "1, 4, 8 or 16; 0: the widest there is")->check(CLI::IsMember({0, 1, 4, 8, 16}))->capture_default_str();
}

void RenderOptions::finish_variant() {
    if (technique.empty()) technique = contains(names_of(mapping_variants), variant) ? "mapping" : "hierarchical";
    const bool hierarchical = technique != "mapping";
    settings.technique = hierarchical ? stages::Technique::Hierarchical : stages::Technique::Mapping;
    if (variant.empty()) variant = hierarchical ? "varying" : "two-sided";
    const auto check = [&](const auto& variants) {
        const auto found = std::find_if(std::begin(variants), std::end(variants), [&](const auto& v) { return variant == v.name; });
        if (found == std::end(variants)) throw std::runtime_error("--variant: " + variant + " is none of --technique " + technique + ", which has " + joined(names_of(variants)));
        return found->variant;
    };
    if (!hierarchical) {
        settings.variant = check(mapping_variants);
        if (settings.discard_wide_splats) throw std::runtime_error("--discard-wide-splats: --technique " + technique + " has no splats that are too wide");
        return;
    }
    const stages::hierarchical::Variant v = settings.hierarchical_variant = check(stages::hierarchical::named_variants);
    settings.variant = stages::mapping::Variant::TwoSided;
    for (const auto& [name, form] : stages::hierarchical::named_splat_forms)
        if (splat_form == name) settings.splat_form = form;
    constexpr int step = stages::hierarchical::map_size_step;
    if (stages::hierarchical::levels_of(v) > 1 && settings.map_size % step != 0)
        throw std::runtime_error("--map-size: --variant " + variant + " needs a multiple of " + std::to_string(step) + ", got " + std::to_string(settings.map_size));
    if (settings.sprite_size > 0 && !stages::hierarchical::has_one_size(v)) throw std::runtime_error("--splat-size: --variant " + variant + " has splats of many sizes");
    if (settings.sprite_size > 0 && settings.sprite_size < stages::hierarchical::narrowest) throw std::runtime_error("--splat-size: --technique hierarchical needs at least 2 texels");
    if (settings.discard_wide_splats && !stages::hierarchical::may_discard(v)) throw std::runtime_error("--discard-wide-splats: --variant " + variant + " has no splats that are too wide");
}

// Exact, unless something is asked for that only image space has.
void RenderOptions::finish_tracing() {
    const stages::Settings usual;
    std::string only;
    if (stages::needs_image_space(settings)) only = "--variant " + variant;
    else if (intersection != RenderOptions().intersection) only = "--intersection";
    else if (settings.iterations != usual.iterations) only = "--iterations";
    else if (settings.solid_layers != usual.solid_layers) only = "--depth-layers";
    if (tracing.empty()) tracing = only.empty() ? "exact" : "image-space";
    if (tracing == "exact" && !only.empty()) throw std::runtime_error("--tracing exact: does not go with " + only);
    settings.tracing = tracing == "exact" ? stages::Tracing::Exact : stages::Tracing::ImageSpace;
}

void RenderOptions::finish(const scenes::Scene& loaded) {
    settings.photons = parse_photons(photons);
    finish_variant();
    finish_tracing();
    settings.intersection = intersection == "newton" ? stages::Intersection::Newton : intersection == "secant" ? stages::Intersection::Secant : stages::Intersection::Bisection;
    while (settings.samples_side * settings.samples_side < samples) ++settings.samples_side;
    picture_size(loaded, settings.width, settings.height);
    if (settings.width * settings.samples_side > max_texture_size || settings.height * settings.samples_side > max_texture_size)
        throw std::runtime_error("--samples: size times samples along an edge must not exceed " + std::to_string(max_texture_size));
    check_memory(loaded, settings);
}

}  // namespace nephroid
