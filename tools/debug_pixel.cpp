#include "tools/debug_pixel.hpp"

// The asm keeps calls to this from being taken out.
extern "C" [[gnu::noinline]] void nephroid_debug_pixel(const nephroid::PixelEvent& event) { __asm__ volatile("" : : "r"(&event) : "memory"); }
