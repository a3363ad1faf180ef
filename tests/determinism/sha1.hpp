// SHA-1 (FIPS 180-4, section 6.1): what picture hashes are made with, without the library that the program takes it from.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace test {

class Sha1 {
public:
    void add(const void* bytes, std::size_t count);
    // The digest of all that was added, as 40 upper-case hexadecimal digits. Nothing may be added afterwards.
    std::string finish();

private:
    static constexpr std::size_t block_bytes = 64;
    void add_block(const unsigned char* block);

    std::uint32_t state_[5] = {0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u, 0xc3d2e1f0u};
    unsigned char pending_[block_bytes] = {};
    std::uint64_t length_ = 0;  // bytes
};

}  // namespace test
