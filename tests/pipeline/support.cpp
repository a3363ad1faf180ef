#include "support.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <tuple>

#include "tests/level.hpp"

namespace test {

int rounds(int usual, int many) {
    return nephroid::test::all_levels() ? many : usual;
}

const std::vector<int>& lane_widths() {
    static const std::vector<int> widths = [] {
        std::vector<int> found;
        for (const int lanes : {1, 4, 8, 16}) {
            Isa isa;
            if (isa_with_lanes(lanes, isa)) found.push_back(lanes);
        }
        return found;
    }();
    return widths;
}

Device& device(int lanes, int threads, int batch_slots) {
    static std::map<std::tuple<int, int, int>, std::unique_ptr<Device>> devices;
    std::unique_ptr<Device>& d = devices[{lanes, threads, batch_slots}];
    if (!d) d = std::make_unique<Device>(DeviceDesc{.threads = threads, .lanes = lanes, .batch_slots = batch_slots});
    return *d;
}

std::string text(const char* format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = std::vsnprintf(nullptr, 0, format, arguments);
    va_end(arguments);
    std::string result(static_cast<std::size_t>(length), '\0');
    std::vsnprintf(result.data(), result.size() + 1, format, again);
    va_end(again);
    return result;
}

std::string describe(const glm::vec4& v) { return text("(%a, %a, %a, %a)", v.x, v.y, v.z, v.w); }

std::string describe(const Faults& faults) {
    char message[4096];
    faults.format(message, sizeof message);
    return message;
}

std::string describe(const PipelineStatistics& s) {
    const auto n = [](std::uint64_t v) { return static_cast<unsigned long long>(v); };
    std::string all = text("ia %llu vertices %llu primitives, vs %llu, gs %llu giving %llu, clipper %llu giving %llu, culled %llu, ps %llu, passed %llu, "
                           "blended %llu, bytes %llu", n(s.ia_vertices), n(s.ia_primitives), n(s.vs_invocations), n(s.gs_invocations), n(s.gs_primitives),
                           n(s.c_invocations), n(s.c_primitives), n(s.culled_primitives), n(s.ps_invocations), n(s.samples_passed), n(s.blended_fragments),
                           n(s.bytes_written));
    for (int k = 0; k < max_streams; ++k) all += text(", stream %d %llu of %llu", k, n(s.so_primitives_written[k]), n(s.so_primitives_needed[k]));
    return all;
}

PipelineStatistics statistics_of(const DrawResult& result) {
    REQUIRE_MESSAGE(result.faults.empty(), describe(result.faults));
    return result.statistics;
}

void must(const Faults& faults) { REQUIRE_MESSAGE(faults.empty(), describe(faults)); }

Picture read(const Texture& texture, int level, int layer) {
    REQUIRE(bytes_per_texel(texture.format()) == 4 * channel_count(texture.format()));
    Picture p{texture.width(level), texture.height(level), channel_count(texture.format()), {}};
    p.values.resize(static_cast<std::size_t>(p.width) * p.height * p.channels);
    texture.download(p.values.data(), level, layer);
    return p;
}

std::vector<std::byte> bytes_of(const Texture& texture, int level, int layer) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(texture.width(level)) * texture.height(level) * bytes_per_texel(texture.format()));
    texture.download(bytes.data(), level, layer);
    return bytes;
}

std::uint64_t hash_of(const void* memory, std::size_t bytes, std::uint64_t seed) {
    std::uint64_t hash = 0xcbf29ce484222325u ^ seed;
    for (std::size_t i = 0; i < bytes; ++i) hash = (hash ^ static_cast<const unsigned char*>(memory)[i]) * 0x100000001b3u;
    return hash;
}

std::uint64_t hash_of(const Texture& texture, std::uint64_t seed) {
    for (int level = 0; level < texture.mip_levels(); ++level) {
        for (int slice = 0; slice < texture.slices(level); ++slice) {
            const std::vector<std::byte> bytes = bytes_of(texture, level, slice);
            seed = hash_of(bytes.data(), bytes.size(), seed);
        }
    }
    return seed;
}

Texture make_target(Format format, int width, int height, int layers, int levels) {
    Texture texture({.format = format, .width = width, .height = height, .layers = layers, .mip_levels = levels,
                     .kind = layers > 1 ? TextureKind::Texture2DArray : TextureKind::Texture2D, .name = "target"});
    must(texture.faults());
    return texture;
}

namespace {

float ndc_for(int subpixel, double origin, double size, double direction) {
    const float ndc = static_cast<float>(direction * ((subpixel / 256.0 - origin) * 2 / size - 1));
    // Float arithmetic errs by some units of the last place of what is added up; a quarter of a subpixel must be enough for that.
    const double landed = ((direction * double{ndc} + 1) * size * 0.5 + origin) * 256;
    const double exact = std::abs(landed - subpixel), slack = std::abs(subpixel / 256.0) * 0x1p-23 * 256;
    const double power = std::exp2(std::round(std::log2(size)));
    const bool exactly = exact == 0 && size == power && origin == std::floor(origin) && std::abs(subpixel) < 1 << 23;
    if (!exactly && exact + slack > 0.25) {
        std::fprintf(stderr, "test set-up: subpixel %d is out of reach in a viewport of size %g at %g\n", subpixel, size, origin);
        std::abort();
    }
    return ndc;
}

}  // namespace

float Frame::ndc_x(int subpixel) const { return ndc_for(subpixel, x, width, 1); }
float Frame::ndc_y(int subpixel) const { return ndc_for(subpixel, y, height, -1); }

std::string ends_well(const std::function<void()>& work) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) return "could not fork";
    if (child == 0) {
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) std::signal(signal, SIG_DFL);
        work();
        _exit(0);
    }
    int status = 0;
    if (waitpid(child, &status, 0) != child) return "could not wait";
    if (WIFSIGNALED(status)) return text("ended by signal %d", WTERMSIG(status));
    if (WEXITSTATUS(status) != 0) return text("exited with %d", WEXITSTATUS(status));
    return "";
}

}  // namespace test
