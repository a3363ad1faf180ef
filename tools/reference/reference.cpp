#include "tools/reference/reference.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "tools/picture_difference.hpp"
#include "tools/reference/camera.hpp"
#include "tools/reference/digest.hpp"
#include "tools/reference/emission.hpp"
#include "tools/reference/eye_tracer.hpp"
#include "tools/reference/film.hpp"
#include "tools/reference/photon_tracer.hpp"

namespace nephroid::reference {

namespace {

constexpr std::uint32_t photons_per_pass = 1u << 16;
constexpr int passes_per_round = 8;  // after which the emission learns; one pass is one thread's work
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
    explicit Desk(std::size_t pixels, std::size_t cells) : film(pixels), lesson{std::vector<double>(cells), std::vector<double>(cells)} {}
    Film film;
    VisiblePoints points;
    Emission::Lesson lesson;
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
          squares(mask.size(), Rgb(0.0)),
          lesson{std::vector<double>(emission.cell_count()), std::vector<double>(emission.cell_count())} {
        const auto masked = static_cast<double>(std::count(mask.begin(), mask.end(), 1));
        if (masked > most_masked * static_cast<double>(mask.size()))
            throw std::runtime_error("outlines of specular objects are in " + std::to_string(std::lround(100 * masked / static_cast<double>(mask.size()))) +
                                     " % of the picture's pixels, where no truth is to be had; more than 5 % is too much: render it larger");
        if (world.media().anywhere() && world.has_specular())
            notes.emplace_back("light that a medium scatters after it came by way of something specular is left out where it is seen through something specular");
        for (std::size_t l = 0; l < lamps.size(); ++l) lamp_regions.push_back(lamps[l].type == scenes::LightType::Directional ? outside_region : world.region_of(lamps[l].position));
    }

    void trace_pass(std::uint64_t pass, Desk& desk) const;
    void fold(const Desk& desk);
    void learn();
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
    std::vector<Rgb> squares;     // of each pass's whole picture
    Emission::Lesson lesson;      // of the round so far
    std::vector<float> importance;
    Account account;
};

void Tracer::Impl::trace_pass(std::uint64_t pass, Desk& desk) const {
    const std::uint64_t seed = mixed(options.seed, pass);
    desk.film.clear();
    desk.points.clear();
    desk.account = {};
    std::fill(desk.lesson.squares.begin(), desk.lesson.squares.end(), 0.0);
    std::fill(desk.lesson.photons.begin(), desk.lesson.photons.end(), 0.0);
    for (std::uint32_t p = 0; p < mask.size(); ++p) {
        Random random(mixed(seed, 1), p);
        eyes.sample(p, random, desk.film, emission.is_empty() ? nullptr : &desk.points);
    }
    if (emission.is_empty()) return;
    desk.points.build(glm::length(world.geometry().high() - world.geometry().low()));
    emission.for_each(mixed(seed, 2), photons_per_pass, [&](const Start& start, std::size_t cell, std::uint32_t number) {
        Random random(mixed(seed, 3), number);
        desk.lesson.squares[cell] += photons.trace(start, start.lamp < 0 ? outside_region : lamp_regions[static_cast<std::size_t>(start.lamp)], random, desk.points, importance, desk.film, desk.account);
        desk.lesson.photons[cell] += importance.empty() ? 0 : 1;
    });
}

void Tracer::Impl::fold(const Desk& desk) {
    halves[passes & 1] += desk.film;
    for (std::size_t p = 0; p < squares.size(); ++p) {
        const Rgb sum = desk.film.sum(p);
        squares[p] += sum * sum;
    }
    for (std::size_t k = 0; k < lesson.photons.size(); ++k) {
        lesson.squares[k] += desk.lesson.squares[k];
        lesson.photons[k] += desk.lesson.photons[k];
    }
    account += desk.account;
    ++passes;
}

// Where relMSE is measured a contribution counts relative to what is there.
void Tracer::Impl::learn() {
    if (emission.is_empty()) return;
    emission.learn(lesson);
    std::fill(lesson.squares.begin(), lesson.squares.end(), 0.0);
    std::fill(lesson.photons.begin(), lesson.photons.end(), 0.0);
    const Film picture = mean(2);
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

void Tracer::run(const Limits& limits, const Listener& listener) {
    Impl& m = *impl_;
    const double start = seconds_now();
    const int threads = m.options.threads > 0 ? m.options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<Desk> desks(static_cast<std::size_t>(std::min(threads, passes_per_round)), Desk(m.mask.size(), m.emission.cell_count()));
    const std::uint64_t least = 4;  // two for each half
    const auto share = [&] {
        double s = 0;
        if (limits.photons > 0) s = std::max(s, static_cast<double>(photons()) / static_cast<double>(limits.photons));
        if (limits.seconds > 0) s = std::max(s, (seconds_now() - start) / limits.seconds);
        return m.passes < least ? std::min(s, static_cast<double>(m.passes) / least) : s;
    };
    for (;;) {
        const std::uint64_t first = m.passes;
        std::uint64_t last = (first / passes_per_round + 1) * passes_per_round;
        if (limits.photons > 0) last = std::min(last, std::max<std::uint64_t>((limits.photons + photons_per_pass - 1) / photons_per_pass, least));
        if (last <= first) return;
        std::atomic<std::uint64_t> next = first;
        std::atomic<bool> over = false;
        std::mutex mutex;
        std::condition_variable folded;
        std::exception_ptr error;
        const auto work = [&](Desk& desk) {
            // Whoever takes a pass finishes it: those before it are with others, or done.
            for (;;) {
                if (over) return;
                const std::uint64_t pass = next++;
                if (pass >= last) return;
                m.trace_pass(pass, desk);
                std::unique_lock lock(mutex);
                folded.wait(lock, [&] { return m.passes == pass; });
                try {
                    m.fold(desk);
                    const double done = share();
                    if (done >= 1) over = true;
                    if (listener) listener(std::min(done, 1.0));
                } catch (...) {
                    error = std::current_exception();
                    over = true;
                    ++m.passes;
                }
                folded.notify_all();
            }
        };
        std::vector<std::thread> others;
        for (std::size_t k = 1; k < desks.size(); ++k) others.emplace_back(work, std::ref(desks[k]));
        work(desks[0]);
        for (std::thread& t : others) t.join();
        if (error) std::rethrow_exception(error);
        if (m.passes % passes_per_round == 0) m.learn();
        if (share() >= 1 || (limits.photons > 0 && m.passes >= last && last % passes_per_round != 0)) return;
        if (limits.noise > 0 && noise() <= limits.noise) return;
    }
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
    for (std::size_t k = 0; k < film.pixels(); ++k) {
        const Rgb mean = film.sum(k), variance = glm::max(m.squares[k] / n - mean * mean, Rgb(0.0)) / std::max(n - 1, 1.0);
        for (int c = 0; c < 3; ++c) p.values.push_back(static_cast<float>(std::sqrt(variance[c])));
    }
    return p;
}

double Tracer::noise() const { return impl_->noise_of(false); }
double Tracer::caustic_noise() const { return impl_->noise_of(true); }
std::uint64_t Tracer::photons() const { return impl_->passes * photons_per_pass; }
int Tracer::passes() const { return static_cast<int>(impl_->passes); }

const std::vector<std::string>& Tracer::notes() const { return impl_->notes; }

namespace {

constexpr char state_begins[] = "nephroid reference 1\n";

void put(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
template <class T> void put(std::string& bytes, const std::vector<T>& v) { put(bytes, v.data(), v.size() * sizeof(T)); }

class Reader {
public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}
    void get(void* data, std::size_t size) {
        if (size > bytes_.size() - at_) throw std::runtime_error("ends too soon to be a picture to go on with");
        std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
    }
    template <class T> void get(std::vector<T>& v) { get(v.data(), v.size() * sizeof(T)); }
    bool at_end() const { return at_ == bytes_.size(); }

private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

}  // namespace

State Tracer::state() const {
    const Impl& m = *impl_;
    State s = state_begins;
    const std::uint64_t header[] = {m.digest, m.options.seed, static_cast<std::uint64_t>(m.options.width), static_cast<std::uint64_t>(m.options.height), static_cast<std::uint64_t>(m.options.max_events), m.passes, m.importance.size()};
    put(s, header, sizeof header);
    for (const Film& f : m.halves)
        for (std::size_t t = 0; t < term_count; ++t) put(s, f.term(t));
    put(s, m.squares);
    put(s, m.importance);
    put(s, m.lesson.squares);
    put(s, m.lesson.photons);
    put(s, m.emission.learned());
    put(s, &m.account, sizeof m.account);
    return s;
}

void Tracer::resume(const State& state) {
    Impl& m = *impl_;
    if (!state.starts_with(state_begins)) throw std::runtime_error("is not a picture to go on with");
    const std::string bytes = state.substr(sizeof state_begins - 1);
    Reader r(bytes);
    std::uint64_t header[7];
    r.get(header, sizeof header);
    if (header[0] != m.digest || header[1] != m.options.seed || header[2] != static_cast<std::uint64_t>(m.options.width) || header[3] != static_cast<std::uint64_t>(m.options.height) ||
        header[4] != static_cast<std::uint64_t>(m.options.max_events) || (header[6] != 0 && header[6] != m.mask.size()))
        throw std::runtime_error("is of another scene, size, seed or number of bounces");
    std::array<Film, 2> halves{Film(m.mask.size()), Film(m.mask.size())};
    for (Film& f : halves)
        for (std::size_t t = 0; t < term_count; ++t) r.get(f.term(t));
    std::vector<Rgb> squares(m.mask.size());
    std::vector<float> importance(header[6]);
    Emission::Lesson lesson = m.lesson;
    std::vector<double> learned(2 * m.emission.cell_count());
    Account account;
    r.get(squares), r.get(importance), r.get(lesson.squares), r.get(lesson.photons), r.get(learned), r.get(&account, sizeof account);
    if (!r.at_end()) throw std::runtime_error("goes on where a picture to go on with would end");
    m.passes = header[5];
    m.halves = std::move(halves);
    m.squares = std::move(squares);
    m.importance = std::move(importance);
    m.lesson = std::move(lesson);
    m.emission.set_learned(learned);
    m.account = account;
}

}  // namespace nephroid::reference
