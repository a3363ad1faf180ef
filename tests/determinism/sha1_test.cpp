// The hash against the examples that FIPS 180 came with, and against itself in pieces.
#include "sha1.hpp"

#include <doctest/doctest.h>

using test::Sha1;

namespace {

std::string sha1_of(const std::string& text) {
    Sha1 hash;
    hash.add(text.data(), text.size());
    return hash.finish();
}

}  // namespace

TEST_CASE("the standard's examples") {
    CHECK(sha1_of("abc") == "A9993E364706816ABA3E25717850C26C9CD0D89D");
    CHECK(sha1_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") == "84983E441C3BD26EBAAE4AA1F95129E5E54670F1");
    CHECK(sha1_of(std::string(1000000, 'a')) == "34AA973CD4C4DAA4F61EEB2BDBAD27316534016F");
    CHECK(sha1_of("") == "DA39A3EE5E6B4B0D3255BFEF95601890AFD80709");
}

TEST_CASE("what is added in pieces hashes as one, at every length around a block's end") {
    std::string text;
    for (int k = 0; k < 200; ++k) text += static_cast<char>(k * 37);
    for (std::size_t length = 0; length < 140; ++length) {
        const std::string whole = sha1_of(text.substr(0, length));
        for (const std::size_t piece : {1, 3, 55, 56, 63, 64, 65}) {
            Sha1 hash;
            for (std::size_t at = 0; at < length; at += piece) hash.add(text.data() + at, std::min(piece, length - at));
            CHECK_MESSAGE(hash.finish() == whole, length, " bytes, ", piece, " at a time");
        }
    }
}
