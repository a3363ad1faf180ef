#include "tools/reference/reference.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "tools/picture_difference.hpp"
#include "tools/printf_text.hpp"
#include "tools/reference/camera.hpp"
#include "tools/reference/digest.hpp"
#include "tools/reference/emission.hpp"
#include "tools/reference/eye_tracer.hpp"
#include "tools/reference/film.hpp"
#include "tools/reference/ordered_passes.hpp"
#include "tools/reference/photon_tracer.hpp"
#include "tools/reference/state_bytes.hpp"

namespace nephroid::reference {

namespace {

// Of a pixel, in a pass: where all round it looks the same, where a medium scatters, and where there is an edge.
constexpr int plain_samples = 1, hazy_samples = 4, edge_samples = 8;
// Before the picture is begun, and not in it: what the pixels hold, then what photons from each cell do to its noise.
constexpr int pilot_rounds = 2;
constexpr std::uint64_t pilot_passes = 2;
constexpr std::uint32_t pilot_photons = 1u << 17;
constexpr double most_masked = 0.05;

const scenes::Camera& camera_of(const scenes::Scene& scene, const Options& options) {
    if (scene.cameras.empty()) throw std::runtime_error("the scene has no camera");
    if (options.width < 1 || options.height < 1) throw std::runtime_error("the picture has no pixels");
    if (options.max_events < 1) throw std::runtime_error("no event may be followed");
    return scene.cameras.front();
}

std::vector<Lamp> lamps_of(const scenes::Scene& scene, const Vec& origin) {
    std::vector<Lamp> lamps;
    for (const scenes::Light& l : scene.lights) lamps.emplace_back(l, origin);
    return lamps;
}

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// What one thread works with.
struct Desk {
    explicit Desk(std::size_t pixels) : film(pixels) {}
    Film film;
    VisiblePoints points;
    Emission::Lesson lesson;  // while piloting
    Account account;
};

}  // namespace

struct Tracer::Impl {
    Impl(const scenes::Scene& s, const Options& o)
        : options(o),
          digest(digest_of(s)),
          world(s),
          camera(camera_of(s, o), world.geometry().origin(), o.width, o.height),
          lamps(lamps_of(s, world.geometry().origin())),
          surroundings(s.environment),
          emission(world, lamps, surroundings),
          eye_region(world.region_of(camera.eye())),
          eyes(world, camera, lamps, surroundings, eye_region, o.max_events),
          photons(world, camera, eye_region, o.max_events),
          mask(eyes.outlines()),
          halves{Film(mask.size()), Film(mask.size())},
          squares(mask.size()),
          sum_squares(mask.size(), Rgb(0.0)) {
        const auto masked = static_cast<double>(std::count(mask.begin(), mask.end(), 1));
        if (masked > most_masked * static_cast<double>(mask.size()))
            throw std::runtime_error("outlines of specular objects are in " + std::to_string(std::lround(100 * masked / static_cast<double>(mask.size()))) +
                                     " % of the picture's pixels, where no truth is to be had; more than 5 % is too much: render it larger");
        if (world.media().anywhere() && world.has_specular())
            notes.emplace_back("light that a medium scatters after it came by way of something specular is left out where it is seen through something specular");
        for (std::size_t l = 0; l < lamps.size(); ++l) lamp_regions.push_back(lamps[l].type == scenes::LightType::Directional ? outside_region : world.region_of(lamps[l].position));
    }

    int threads() const { return options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }
    void trace_pass(std::uint64_t seed, std::uint32_t photon_count, Desk& desk) const;
    void fold(const Desk& desk);
    void pilot(std::vector<Desk>& desks);
    void set_importance(const Film& picture);
    void find_edges(const Film& picture);
    Film mean(int half) const;  // 0, 1; or 2: of both
    double noise_of(bool caustic_only) const;

    const Options options;
    const std::uint64_t digest;
    const World world;
    const Camera camera;
    const std::vector<Lamp> lamps;
    const Surroundings surroundings;
    Emission emission;
    const Region eye_region;
    std::vector<Region> lamp_regions;
    const EyeTracer eyes;
    const PhotonTracer photons;
    const std::vector<std::uint8_t> mask;

    std::vector<std::string> notes;

    std::uint64_t passes = 0;
    std::array<Film, 2> halves;   // sums over even and odd passes
    Film squares;                     // sums of each pass's terms, squared
    std::vector<Rgb> sum_squares;     // and of their sum
    bool is_piloted = false;
    std::vector<float> importance;  // while piloting
    std::vector<std::uint8_t> edges;
    Account account;
};

void Tracer::Impl::trace_pass(std::uint64_t seed, std::uint32_t photon_count, Desk& desk) const {
    desk.film.clear();
    desk.points.clear();
    desk.account = {};
    for (std::uint32_t p = 0; p < mask.size(); ++p) {
        Random random(mixed(seed, 1), p);
        const int samples = !edges.empty() && edges[p] ? edge_samples : world.media().anywhere() ? hazy_samples : plain_samples;
        for (int k = 0; k < samples; ++k) eyes.sample(p, 1.0 / samples, random, desk.film, emission.is_empty() ? nullptr : &desk.points);
    }
    if (emission.is_empty()) return;
    desk.points.build(glm::length(world.geometry().high() - world.geometry().low()));
    emission.for_each(mixed(seed, 2), photon_count, [&](const Start& start, std::size_t cell, std::uint32_t number) {
        Random random(mixed(seed, 3), number);
        const Region region = start.lamp < 0 ? outside_region : lamp_regions[static_cast<std::size_t>(start.lamp)];
        const double squares_of_photon = photons.trace(start, region, random, desk.points, importance, desk.film, desk.account);
        if (importance.empty()) return;
        desk.lesson.squares[cell] += squares_of_photon;
        desk.lesson.photons[cell] += 1;
    });
}

void Tracer::Impl::fold(const Desk& desk) {
    halves[passes & 1] += desk.film;
    for (std::size_t p = 0; p < mask.size(); ++p) {
        for (std::size_t t = 0; t < term_count; ++t) squares.term(t)[p] += desk.film.term(t)[p] * desk.film.term(t)[p];
        sum_squares[p] += desk.film.sum(p) * desk.film.sum(p);
    }
    account += desk.account;
    ++passes;
}

void Tracer::Impl::pilot(std::vector<Desk>& desks) {
    if (is_piloted) return;
    is_piloted = true;
    for (int round = 0; round < pilot_rounds; ++round) {
        Film picture(mask.size());
        Emission::Lesson lesson{std::vector<double>(emission.cell_count()), std::vector<double>(emission.cell_count())};
        run_passes(
            0, pilot_passes, desks,
            [&](std::uint64_t pass, Desk& desk) {
                desk.lesson = {std::vector<double>(emission.cell_count()), std::vector<double>(emission.cell_count())};
                trace_pass(mixed(mixed(~options.seed, pass), static_cast<std::uint64_t>(round)), std::min(pilot_photons, options.photons_per_pass), desk);
            },
            [&](Desk& desk) {
                picture += desk.film;
                for (std::size_t k = 0; k < lesson.photons.size(); ++k) {
                    lesson.squares[k] += desk.lesson.squares[k];
                    lesson.photons[k] += desk.lesson.photons[k];
                }
                return false;
            });
        for (std::size_t t = 0; t < term_count; ++t)
            for (Rgb& v : picture.term(t)) v /= static_cast<double>(pilot_passes);
        if (!importance.empty() && !emission.is_empty()) emission.learn(lesson);
        if (round + 1 < pilot_rounds) set_importance(picture);
        else find_edges(picture);
    }
    importance.clear();
}

// Where what is seen without photons changes by more than a little from one pixel to the next.
void Tracer::Impl::find_edges(const Film& picture) {
    constexpr double little = 0.15;
    const auto seen = [&](int x, int y) {
        const auto p = static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(x);
        return luminance(picture.term(static_cast<std::size_t>(Term::Direct))[p] + picture.term(static_cast<std::size_t>(Term::Emission))[p]);
    };
    edges.assign(mask.size(), 0);
    for (int y = 0; y < options.height; ++y)
        for (int x = 0; x < options.width; ++x) {
            double low = std::numeric_limits<double>::infinity(), high = 0;
            for (int v = std::max(y - 1, 0); v <= std::min(y + 1, options.height - 1); ++v)
                for (int u = std::max(x - 1, 0); u <= std::min(x + 1, options.width - 1); ++u) low = std::min(low, seen(u, v)), high = std::max(high, seen(u, v));
            edges[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(x)] = high - low > little * high;
        }
}

// A contribution counts as relMSE counts it: relative to what is there.
void Tracer::Impl::set_importance(const Film& picture) {
    double sum = 0;
    for (std::size_t p = 0; p < mask.size(); ++p) sum += luminance(picture.sum(p));
    const double epsilon = 0.1 * sum / static_cast<double>(mask.size());
    importance.assign(mask.size(), 0.0f);
    if (!(epsilon > 0)) return;
    for (std::size_t p = 0; p < mask.size(); ++p) importance[p] = mask[p] ? 0.0f : static_cast<float>(1 / std::hypot(luminance(picture.sum(p)), epsilon));
}

Film Tracer::Impl::mean(int half) const {
    Film film = halves[half == 1];
    if (half == 2) film += halves[1];
    const std::uint64_t even = (passes + 1) / 2, count = half == 2 ? passes : half == 0 ? even : passes - even;
    for (std::size_t t = 0; t < term_count; ++t)
        for (Rgb& value : film.term(t)) value /= static_cast<double>(std::max<std::uint64_t>(count, 1));
    return film;
}

namespace {

PictureData rgb_of(const Film& film, int width, int height) {
    PictureData p{width, height, {"R", "G", "B"}, {}};
    for (std::size_t k = 0; k < film.pixels(); ++k) {
        const Rgb sum = film.sum(k);
        for (int c = 0; c < 3; ++c) p.values.push_back(static_cast<float>(sum[c]));
    }
    return p;
}

}  // namespace

// (A - B)^2 / 4 is the variance of (A + B) / 2, which is (A - mean)^2.
double Tracer::Impl::noise_of(bool caustic_only) const {
    if (passes < 2) return std::numeric_limits<double>::infinity();
    const Film both = mean(2);
    const PictureData half = rgb_of(mean(0), options.width, options.height), whole = rgb_of(both, options.width, options.height);
    PixelMask left_out(mask.begin(), mask.end());
    if (caustic_only) {
        PictureData caustic{options.width, options.height, {"R", "G", "B"}, {}};
        for (const Rgb& v : both.term(0)) caustic.values.insert(caustic.values.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
        left_out = not_caustic(whole, caustic, left_out);
    }
    if (std::find(left_out.begin(), left_out.end(), false) == left_out.end()) return 0;
    return measure(half, whole, left_out).relative_mse;
}

Tracer::Tracer(const scenes::Scene& scene, const Options& options) : impl_(std::make_unique<Impl>(scene, options)) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

void Tracer::run(const Limits& limits, const Listener& listener) {
    Impl& m = *impl_;
    const double start = seconds_now();
    std::vector<Desk> desks(static_cast<std::size_t>(m.threads()), Desk(m.mask.size()));
    m.pilot(desks);
    constexpr std::uint64_t least = 4;  // two for each half
    const std::uint64_t most = limits.photons > 0 ? std::max<std::uint64_t>((limits.photons + m.options.photons_per_pass - 1) / m.options.photons_per_pass, least) : std::numeric_limits<std::uint64_t>::max();
    const auto fold = [&](Desk& desk) {
        m.fold(desk);
        double share = static_cast<double>(m.passes) / static_cast<double>(most);
        if (limits.seconds > 0) share = std::max(share, (seconds_now() - start) / limits.seconds);
        // The halves are equal after every second pass; noise falls like 1 / passes.
        if (limits.noise > 0 && m.passes >= least && m.passes % 2 == 0) share = std::max(share, limits.noise / std::max(noise(), 1e-300));
        if (listener) listener(std::min(share, 1.0));
        return share >= 1 && m.passes >= least;
    };
    run_passes(m.passes, most, desks, [&](std::uint64_t pass, Desk& desk) { m.trace_pass(mixed(m.options.seed, pass), m.options.photons_per_pass, desk); }, fold);
}

PictureData Tracer::picture() const {
    const Impl& m = *impl_;
    const Film film = m.mean(2);
    // In the order in which a reader of EXR sorts the layers.
    PictureData p{m.options.width, m.options.height, {"R", "G", "B"}, {}};
    for (const char* name : term_names)
        for (const char* c : {".R", ".G", ".B"}) p.channels.push_back(std::string(name) + c);
    p.channels.emplace_back("mask");
    for (std::size_t k = 0; k < film.pixels(); ++k) {
        const Rgb sum = film.sum(k);
        for (int c = 0; c < 3; ++c) p.values.push_back(static_cast<float>(sum[c]));
        for (std::size_t t = 0; t < term_count; ++t)
            for (int c = 0; c < 3; ++c) p.values.push_back(static_cast<float>(film.term(t)[k][c]));
        p.values.push_back(m.mask[k]);
    }
    return p;
}

PictureData Tracer::error() const {
    const Impl& m = *impl_;
    const Film film = m.mean(2);
    const double n = static_cast<double>(m.passes);
    PictureData p{m.options.width, m.options.height, {"R.error", "G.error", "B.error"}, {}};
    for (const char* name : term_names)
        for (const char* c : {".R.error", ".G.error", ".B.error"}) p.channels.push_back(std::string(name) + c);
    const auto put = [&](const Rgb& mean, const Rgb& squares) {
        const Rgb variance = glm::max(squares / n - mean * mean, Rgb(0.0)) / std::max(n - 1, 1.0);
        for (int c = 0; c < 3; ++c) p.values.push_back(static_cast<float>(std::sqrt(variance[c])));
    };
    for (std::size_t k = 0; k < film.pixels(); ++k) {
        put(film.sum(k), m.sum_squares[k]);
        for (std::size_t t = 0; t < term_count; ++t) put(film.term(t)[k], m.squares.term(t)[k]);
    }
    return p;
}

Account Tracer::account() const {
    Account a = impl_->account;
    const double n = static_cast<double>(std::max<std::uint64_t>(impl_->passes, 1));
    for (Rgb* term : {&a.emitted, &a.deposited, &a.absorbed, &a.escaped, &a.truncated, &a.correction}) *term /= n;
    return a;
}

double Tracer::noise() const { return impl_->noise_of(false); }
double Tracer::caustic_noise() const { return impl_->noise_of(true); }
std::uint64_t Tracer::photons() const { return impl_->passes * impl_->options.photons_per_pass; }
int Tracer::passes() const { return static_cast<int>(impl_->passes); }

std::vector<std::pair<std::string, std::string>> Tracer::metadata() const {
    return {{scene_name, text_of_digest(impl_->digest)}, {photons_name, std::to_string(photons())}, {noise_name, printf_text("%.4g", noise())}, {caustic_noise_name, printf_text("%.4g", caustic_noise())}};
}

const std::vector<std::string>& Tracer::notes() const { return impl_->notes; }

namespace {

constexpr char state_begins[] = "nephroid reference 1\n";

}  // namespace

State Tracer::state() const {
    const Impl& m = *impl_;
    State s = state_begins;
    const std::uint64_t header[] = {m.digest, m.options.seed, m.options.photons_per_pass, static_cast<std::uint64_t>(m.options.width), static_cast<std::uint64_t>(m.options.height), static_cast<std::uint64_t>(m.options.max_events), m.passes};
    put(s, header, sizeof header);
    for (const Film& f : m.halves)
        for (std::size_t t = 0; t < term_count; ++t) put(s, f.term(t));
    for (std::size_t t = 0; t < term_count; ++t) put(s, m.squares.term(t));
    put(s, m.sum_squares);
    put(s, m.edges);
    put(s, m.emission.learned());
    put(s, &m.account, sizeof m.account);
    return s;
}

void Tracer::resume(const State& state) {
    Impl& m = *impl_;
    if (!state.starts_with(state_begins)) throw std::runtime_error("is not a picture to go on with");
    const std::string bytes = state.substr(sizeof state_begins - 1);
    StateReader r(bytes);
    std::uint64_t header[7];
    r.get(header, sizeof header);
    if (header[0] != m.digest || header[1] != m.options.seed || header[2] != m.options.photons_per_pass ||
        header[3] != static_cast<std::uint64_t>(m.options.width) || header[4] != static_cast<std::uint64_t>(m.options.height) || header[5] != static_cast<std::uint64_t>(m.options.max_events))
        throw std::runtime_error("is of another scene, size, seed or number of bounces");
    std::array<Film, 2> halves{Film(m.mask.size()), Film(m.mask.size())};
    Film squares(m.mask.size());
    for (Film* f : {&halves[0], &halves[1], &squares})
        for (std::size_t t = 0; t < term_count; ++t) r.get(f->term(t));
    std::vector<Rgb> sum_squares(m.mask.size());
    std::vector<std::uint8_t> edges(m.mask.size());
    std::vector<double> learned(2 * m.emission.cell_count());
    Account account;
    r.get(sum_squares), r.get(edges), r.get(learned), r.get(&account, sizeof account);
    if (!r.at_end()) throw std::runtime_error("goes on where a picture to go on with would end");
    m.passes = header[6];
    m.halves = std::move(halves);
    m.squares = std::move(squares);
    m.sum_squares = std::move(sum_squares);
    m.is_piloted = true;
    m.edges = std::move(edges);
    m.emission.set_learned(learned);
    m.account = account;
}

}  // namespace nephroid::reference
