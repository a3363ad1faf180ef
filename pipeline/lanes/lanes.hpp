// N values of a 32-bit type in one vector register, with the same meaning as N separate scalars.
//
// Every operation is exactly what the scalar operation of the same name in scalar.hpp does, lane by lane, on every
// instruction set: IEEE 754 binary32 rounded to nearest even, denormals kept, no estimates, no fused multiply-add.
// The element-wise operators are the compiler's own for vector types of the native width; what they cannot express
// (masks, selects, square roots, conversions, gathers) is written with intrinsics, one file per instruction set.
//
// A Lanes<T, N> is usable only in sources compiled for the instruction set with N lanes (see kernels in README.md).
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace nephroid {

// One truth value per lane. The representation is the instruction set's; the interface is here and in its file.
template <int N>
struct Mask;

// The compiler's vector type. (A typedef: an alias-declaration drops the attribute while T is still unknown.)
template <class T, int N>
struct NativeVector {
    typedef T type __attribute__((vector_size(sizeof(T) * N)));
};

template <class T, int N>
struct alignas(sizeof(T) * N) Lanes {
    static_assert(sizeof(T) == 4, "lanes hold 32-bit values");
    using value_type = T;
    using Native = typename NativeVector<T, N>::type;
    static constexpr int size = N;

    Native v;

    Lanes() = default;
    Lanes(T scalar) : Lanes(scalar, std::make_integer_sequence<int, N>{}) {}
    explicit Lanes(Native native) : v(native) {}
    // Value conversions are spelled out: see convert<To>() and bit_cast_lanes<To>().
    template <class U>
    explicit Lanes(const Lanes<U, N>&) = delete;

    T operator[](int lane) const { return v[lane]; }

    friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
    friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
    friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
    friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
    friend Lanes operator&(Lanes a, Lanes b) { return Lanes(a.v & b.v); }
    friend Lanes operator|(Lanes a, Lanes b) { return Lanes(a.v | b.v); }
    friend Lanes operator^(Lanes a, Lanes b) { return Lanes(a.v ^ b.v); }
    friend Lanes operator<<(Lanes a, int bits) { return Lanes(a.v << bits); }
    friend Lanes operator>>(Lanes a, int bits) { return Lanes(a.v >> bits); }  // arithmetic where T is signed
    friend Lanes operator<<(Lanes a, Lanes bits) { return Lanes(a.v << bits.v); }
    friend Lanes operator>>(Lanes a, Lanes bits) { return Lanes(a.v >> bits.v); }
    Lanes operator-() const { return Lanes(-v); }
    Lanes operator~() const { return Lanes(~v); }
    Lanes operator+() const { return *this; }
    Lanes& operator+=(Lanes b) { return *this = *this + b; }
    Lanes& operator-=(Lanes b) { return *this = *this - b; }
    Lanes& operator*=(Lanes b) { return *this = *this * b; }
    Lanes& operator/=(Lanes b) { return *this = *this / b; }
    Lanes& operator&=(Lanes b) { return *this = *this & b; }
    Lanes& operator|=(Lanes b) { return *this = *this | b; }
    Lanes& operator^=(Lanes b) { return *this = *this ^ b; }

private:
    template <int... I>
    Lanes(T scalar, std::integer_sequence<int, I...>) : v(Native{((void)I, scalar)...}) {}
};

template <int N>
using FloatLanes = Lanes<float, N>;
template <int N>
using IntLanes = Lanes<std::int32_t, N>;
template <int N>
using UintLanes = Lanes<std::uint32_t, N>;

}  // namespace nephroid

// GLM asks for these before it lets a type into its vectors.
template <class T, int N>
class std::numeric_limits<nephroid::Lanes<T, N>> : public std::numeric_limits<T> {};
