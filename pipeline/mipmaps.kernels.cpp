// A level's rows from those of the level before: decode up to three by three rows, combine along x, y and z, encode.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "pipeline/mip_kernels.hpp"
#include "pipeline/texel.hpp"
#include "pipeline/texel_lanes.hpp"

namespace nephroid {

namespace {

// Rows are worked on in pieces, so that everything between decoding and encoding fits the first-level cache.
constexpr int piece_texels = 128;                            // of the coarser level
constexpr int padding = 64;                                  // floats that vector loads and stores may reach beyond the end
constexpr int piece_floats = 4 * piece_texels + padding;
constexpr int source_floats = 4 * (2 * piece_texels + 1) + 2 * padding;

// ---- texels and floats, channel after channel and texel after texel

template <class F, class Narrow>
LaneUint<F> load_narrow(const Narrow* at) {
    if constexpr (lanes_of<F> == 1) {
        return *at;
    } else {
        // Bytes in two steps: compilers know how to double a width, and take quadrupling apart into single bytes.
        typename NativeVector<Narrow, lanes_of<F>>::type v;
        std::memcpy(&v, at, sizeof v);
        const auto words = __builtin_convertvector(v, typename NativeVector<std::uint16_t, lanes_of<F>>::type);
        return LaneUint<F>(__builtin_convertvector(words, typename LaneUint<F>::Native));
    }
}
template <class F, class Narrow>
void store_narrow(Narrow* at, LaneUint<F> value) {
    if constexpr (lanes_of<F> == 1) {
        *at = static_cast<Narrow>(value);
    } else {
        const auto words = __builtin_convertvector(value.v, typename NativeVector<std::uint16_t, lanes_of<F>>::type);
        const auto v = __builtin_convertvector(words, typename NativeVector<Narrow, lanes_of<F>>::type);
        std::memcpy(at, &v, sizeof v);
    }
}

// The narrow formats go through a copy, as vector loads must not run past a texture's end nor stores past a row's.
template <Format format, class F>
void decode_row(const std::byte* texels, int count, float* out) {
    constexpr int lanes = lanes_of<F>, channels = channel_count(format);
    const std::size_t bytes = static_cast<std::size_t>(count) * bytes_per_texel(format);
    if constexpr (format == Format::RGBA16F) {
        std::uint16_t halves[source_floats];
        std::memcpy(halves, texels, bytes);
        std::fill_n(halves + count * channels, lanes, std::uint16_t{0});
        for (int k = 0; k < count * channels; k += lanes) store_lanes(out + k, half_to_float(load_narrow<F>(halves + k)));
    } else if constexpr (format == Format::RGBA8) {
        std::uint8_t values[source_floats];
        std::memcpy(values, texels, bytes);
        std::fill_n(values + count * channels, lanes, std::uint8_t{0});
        for (int k = 0; k < count * channels; k += lanes) store_lanes(out + k, unorm8_to_float<F>(load_narrow<F>(values + k)));
    } else if constexpr (format == Format::RGBA8Srgb) {
        for (int x = 0; x < count; ++x) {
            const Color4 c = load_texel<format>(texels + 4 * x);
            std::memcpy(out + 4 * x, &c, sizeof c);
        }
    } else {
        std::memcpy(out, texels, bytes);
    }
}

template <Format format, class F>
void encode_row(const float* values, int count, std::byte* texels) {
    constexpr int lanes = lanes_of<F>, channels = channel_count(format);
    const std::size_t bytes = static_cast<std::size_t>(count) * bytes_per_texel(format);
    if constexpr (format == Format::RGBA16F) {
        std::uint16_t halves[piece_floats];
        for (int k = 0; k < count * channels; k += lanes) store_narrow<F>(halves + k, float_to_half(load_lanes<F>(values + k)));
        std::memcpy(texels, halves, bytes);
    } else if constexpr (format == Format::RGBA8) {
        std::uint8_t narrow[piece_floats];
        for (int k = 0; k < count * channels; k += lanes) {
            const F v = min(max(F(0.0f), load_lanes<F>(values + k)), 1.0f) * 255.0f;
            store_narrow<F>(narrow + k, as_uint(to_int_in_range(round_even(v))));
        }
        std::memcpy(texels, narrow, bytes);
    } else if constexpr (format == Format::RGBA8Srgb) {
        for (int x = 0; x < count; ++x) {
            Color4 c;
            std::memcpy(&c, values + 4 * x, sizeof c);
            store_texel<format>(texels + 4 * x, c);
        }
    } else if constexpr (format == Format::R32U) {
        std::memcpy(texels, values, bytes);
    } else {
        float stored[piece_floats];
        for (int k = 0; k < count * channels; k += lanes) {
            const F v = load_lanes<F>(values + k);
            store_lanes(stored + k, select(v == v, v, F(canonical_nan)));
        }
        std::memcpy(texels, stored, bytes);
    }
}

// ---- what to do with the values. Integers travel as the floats of the same bits.

template <MipOperation operation, bool integer, class F>
F combine(F a, F b) {
    if constexpr (operation == MipOperation::Average) {
        return a + b;
    } else if constexpr (integer) {
        const LaneUint<F> u = float_bits(a), v = float_bits(b);
        return bits_float(operation == MipOperation::Min ? min(u, v) : max(u, v));
    } else {
        // A NaN gives way to whatever comes.
        const LaneMask<F> take_b = operation == MipOperation::Min ? b < a : a < b, a_is_nan = a != a;
        return select(take_b | a_is_nan, b, a);
    }
}
// Any is the largest of values that have been made 0 or 1 beforehand.
template <bool integer, class F>
F not_zero(F a) {
    if constexpr (integer) return bits_float(select(float_bits(a) != 0u, LaneUint<F>(1u), LaneUint<F>(0u)));
    else return select(a != 0.0f, F(1.0f), F(0.0f));
}
template <class F>
F average_of_three(F a, F b, F c, F w0, F w2) {
    return b + (w0 * (a - b) + w2 * (c - b));
}

// Which texels of an axis make texel i of the next level.
struct AxisTaps {
    int first, count;
    float w0 = 0, w2 = 0;  // Average, of three
};
AxisTaps axis_taps(MipOperation operation, int from, int to, int i) {
    if (from == to) return {i, 1};
    const bool odd = from % 2 != 0;
    if (!odd) return {2 * i, 2};
    if (operation != MipOperation::Average) return {2 * i, i == to - 1 ? 3 : 2};
    const float n = static_cast<float>(from);
    return {2 * i, 3, static_cast<float>(to - i) / n, static_cast<float>(i + 1) / n};
}

// Values of up to three rows or slices to one.
template <MipOperation operation, bool integer, class F>
void combine_rows(float (*rows)[piece_floats], const AxisTaps& taps, int floats, float* out) {
    for (int k = 0; k < floats; k += lanes_of<F>) {
        F v = load_lanes<F>(rows[0] + k);
        if (taps.count >= 2) {
            const F b = load_lanes<F>(rows[1] + k);
            if (taps.count == 2) {
                v = combine<operation, integer>(v, b);
            } else {
                const F c = load_lanes<F>(rows[2] + k);
                if constexpr (operation == MipOperation::Average) v = average_of_three(v, b, c, F(taps.w0), F(taps.w2));
                else v = combine<operation, integer>(combine<operation, integer>(v, b), c);
            }
        }
        store_lanes(out + k, v);
    }
}

// Every second texel of two vectors' worth, from the first or from the second on.
template <int channels, int offset, class F, int... K>
F every_second(F low, F high, std::integer_sequence<int, K...>) {
    return F(__builtin_shufflevector(low.v, high.v, (K / channels * 2 * channels + offset * channels + K % channels)...));
}
// Texels 2 i + offset of a row, beginning where a vector of outputs begins at float k.
template <int channels, int offset, class F>
F load_every_second(const float* row, int k) {
    if constexpr (lanes_of<F> == 1 || lanes_of<F> < channels) {
        return load_lanes<F>(row + (k / channels * 2 + offset) * channels + k % channels);
    } else {
        const float* at = row + 2 * k + (offset == 2 ? 2 * channels : 0);
        return every_second<channels, offset % 2>(load_lanes<F>(at), load_lanes<F>(at + lanes_of<F>), std::make_integer_sequence<int, lanes_of<F>>{});
    }
}

// A row's texels to those of the coarser level, first ... first + count - 1 of `to`.
template <MipOperation operation, bool integer, int channels, class F>
void combine_texels(const float* row, int from, int to, int first, int count, float* out) {
    const int floats = count * channels;
    if (from == to) {
        std::memcpy(out, row, static_cast<std::size_t>(floats) * sizeof(float));
        return;
    }
    const bool odd = from % 2 != 0;
    if (odd && operation == MipOperation::Average) {
        float w0[piece_floats], w2[piece_floats];
        for (int i = 0; i < count; ++i) {
            const AxisTaps taps = axis_taps(operation, from, to, first + i);
            for (int c = 0; c < channels; ++c) w0[i * channels + c] = taps.w0, w2[i * channels + c] = taps.w2;
        }
        std::fill_n(w0 + floats, padding, 0.0f);
        std::fill_n(w2 + floats, padding, 0.0f);
        for (int k = 0; k < floats; k += lanes_of<F>) {
            const F a = load_every_second<channels, 0, F>(row, k), b = load_every_second<channels, 1, F>(row, k), c = load_every_second<channels, 2, F>(row, k);
            store_lanes(out + k, average_of_three(a, b, c, load_lanes<F>(w0 + k), load_lanes<F>(w2 + k)));
        }
        return;
    }
    for (int k = 0; k < floats; k += lanes_of<F>)
        store_lanes(out + k, combine<operation, integer>(load_every_second<channels, 0, F>(row, k), load_every_second<channels, 1, F>(row, k)));
    if (odd && first + count == to) {
        const float* third = row + 2 * floats;
        for (int c = 0; c < channels; ++c) {
            float& last = out[floats - channels + c];
            last = combine<operation, integer>(last, third[c]);
        }
    }
}

// ---- rows

template <Format format, MipOperation operation, class F>
void compute_rows_of(const TextureLevel& from, const TextureLevel& to, int first_row, int last_row) {
    constexpr bool integer = format == Format::R32U;
    constexpr MipOperation merge = operation == MipOperation::Any ? MipOperation::Max : operation;
    constexpr int channels = channel_count(format), texel_bytes = bytes_per_texel(format);
    alignas(64) float source[source_floats] = {}, rows[3][piece_floats] = {}, slices[3][piece_floats] = {}, result[piece_floats];
    const auto texel = [](const TextureLevel& level, int x, int y, int slice) {
        return level.data + ((static_cast<std::size_t>(slice) * level.slice_pitch) + static_cast<std::size_t>(y) * level.row_pitch + x) * texel_bytes;
    };
    for (int r = first_row; r < last_row; ++r) {
        const AxisTaps y = axis_taps(operation, from.height, to.height, r % to.height), z = axis_taps(operation, from.slices, to.slices, r / to.height);
        // Each even axis leaves sums of two.
        const auto halved = [&](int fine, int coarse) { return fine != coarse && fine % 2 == 0 ? 0.5f : 1.0f; };
        const float scale = halved(from.width, to.width) * halved(from.height, to.height) * halved(from.slices, to.slices);
        for (int x = 0; x < to.width; x += piece_texels) {
            const int count = std::min(piece_texels, to.width - x), floats = count * channels;
            const int first = from.width == to.width ? x : 2 * x;
            const int sources = from.width == to.width ? count : std::min(2 * count + 1, from.width - first);
            for (int k = 0; k < z.count; ++k) {
                for (int j = 0; j < y.count; ++j) {
                    decode_row<format, F>(texel(from, first, y.first + j, z.first + k), sources, source);
                    if constexpr (operation == MipOperation::Any)
                        for (int i = 0; i < sources * channels; i += lanes_of<F>) store_lanes(source + i, not_zero<integer>(load_lanes<F>(source + i)));
                    combine_texels<merge, integer, channels, F>(source, from.width, to.width, x, count, rows[j]);
                }
                combine_rows<merge, integer, F>(rows, y, floats, slices[k]);
            }
            combine_rows<merge, integer, F>(slices, z, floats, result);
            if constexpr (operation == MipOperation::Average)
                for (int i = 0; i < floats; i += lanes_of<F>) store_lanes(result + i, load_lanes<F>(result + i) * scale);
            encode_row<format, F>(result, count, texel(to, x, r % to.height, r / to.height));
        }
    }
}

template <MipOperation operation, class F>
void compute_rows_by(Format format, const TextureLevel& from, const TextureLevel& to, int first_row, int last_row) {
    switch (format) {
        case Format::R32F: return compute_rows_of<Format::R32F, operation, F>(from, to, first_row, last_row);
        case Format::RG32F: return compute_rows_of<Format::RG32F, operation, F>(from, to, first_row, last_row);
        case Format::RGBA32F: return compute_rows_of<Format::RGBA32F, operation, F>(from, to, first_row, last_row);
        case Format::RGBA16F: return compute_rows_of<Format::RGBA16F, operation, F>(from, to, first_row, last_row);
        case Format::RGBA8: return compute_rows_of<Format::RGBA8, operation, F>(from, to, first_row, last_row);
        case Format::RGBA8Srgb: return compute_rows_of<Format::RGBA8Srgb, operation, F>(from, to, first_row, last_row);
        case Format::D32F: return compute_rows_of<Format::D32F, operation, F>(from, to, first_row, last_row);
        case Format::R32U:
            if constexpr (operation != MipOperation::Average) compute_rows_of<Format::R32U, operation, F>(from, to, first_row, last_row);
            return;
    }
}

template <class F>
void compute_rows(Format format, MipOperation operation, const TextureLevel& from, const TextureLevel& to, int first_row, int last_row) {
    switch (operation) {
        case MipOperation::Average: return compute_rows_by<MipOperation::Average, F>(format, from, to, first_row, last_row);
        case MipOperation::Min: return compute_rows_by<MipOperation::Min, F>(format, from, to, first_row, last_row);
        case MipOperation::Max: return compute_rows_by<MipOperation::Max, F>(format, from, to, first_row, last_row);
        case MipOperation::Any: return compute_rows_by<MipOperation::Any, F>(format, from, to, first_row, last_row);
    }
}

}  // namespace

template <Isa isa>
const MipKernelTable& MipKernels<isa>::table() {
    static constexpr MipKernelTable kernels{&compute_rows<typename IsaFloat<isa>::type>};
    return kernels;
}

template struct MipKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
