// Which columns of a tile's rows lie inside three edges: pixel by pixel what the edges themselves say, exact integers.
#include "pipeline/triangle_rows.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "pipeline/draw_context.hpp"
#include "support.hpp"

using namespace nephroid;

TEST_CASE("A row's columns are those whose pixels are inside all edges, for edges of any length") {
    test::Random random(77);
    long inside = 0, outside = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        TileEdge edges[3] = {};
        // Steps of up to 2^23, as the guard band allows, down to one, zeros among them.
        const int bits = random.integer(0, 23);
        for (TileEdge& e : edges) {
            const auto step = [&] { return random.one_in(8) ? 0 : random.integer(-(1 << bits), 1 << bits); };
            const int step_x = step(), step_y = step();
            // The edge meets a pixel of the tile, or comes as near as its neighbours in value.
            const int x = random.integer(0, tile_size - 1), y = random.integer(0, tile_size - 1);
            const TileEdge through{-x * step_x - y * step_y + random.integer(-1, 1), step_x, step_y};
            const int lowest = std::min({through.at(0, 0), through.at(tile_size - 1, 0), through.at(0, tile_size - 1), through.at(tile_size - 1, tile_size - 1)});
            if (lowest < 0 && (step_x != 0 || step_y != 0)) e = through;  // others are inside everywhere, or refused before
        }
        const TriangleRows<float> rows(edges, tile_size);
        const int left = random.integer(0, tile_size - 1), right = random.integer(left, tile_size - 1);
        for (int y = 0; y < tile_size; y += random.integer(1, 9)) {
            const TriangleRows<float>::Columns columns = rows.columns(y, left, right);
            if (columns.first <= columns.last) REQUIRE((columns.first >= left && columns.last <= right));
            for (int x = left; x <= right; ++x) {
                const bool covered = std::all_of(std::begin(edges), std::end(edges), [&](const TileEdge& e) { return e.at(x, y) >= 0; });
                (covered ? inside : outside)++;
                if (covered != (x >= columns.first && x <= columns.last)) FAIL("trial ", trial, ": pixel ", x, ", ", y, covered ? std::string(" is inside") : std::string(" is outside"), ", columns ", columns.first, " to ", columns.last);
            }
        }
    }
    CHECK(inside > 100000);
    CHECK(outside > 100000);
}
