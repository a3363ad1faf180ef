// Stream output.
//   in:  per batch, the vertices and primitives of each stream
//   out: whole vertex structs in the bound buffers, in input-primitive order, strips taken apart
//
// Count, exclusive prefix sum, write: first every batch's primitives are counted and given their places, then the batches
// write, in parallel. A primitive that does not fit whole into what is left of a buffer is not written, nor is any after
// it; all are counted as needed.
#pragma once
#include "pipeline/draw_context.hpp"

namespace nephroid {

struct StreamCursor {
    bool bound = false;
    std::byte* data = nullptr;  // null where the buffer holds nothing
    std::int64_t capacity = 0;  // primitives that fit, from the stream's start
    std::int64_t next = 0;      // primitives so far, fitting or not
};

// Places of one batch in each stream, and how many of its primitives fit there.
struct StreamPlaces {
    std::int64_t first[max_streams];
    int count[max_streams];
};

StreamPlaces place_streams(const DrawContext& draw, Batch& batch, StreamCursor cursors[max_streams]);
void write_streams(const DrawContext& draw, const Batch& batch, const StreamPlaces& places, const StreamCursor cursors[max_streams]);

}  // namespace nephroid
