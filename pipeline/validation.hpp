// Looks for all faults of a draw before anything is written.
#pragma once
#include "pipeline/device.hpp"

namespace nephroid {

Faults validate(const ProgramRef& program, const PipelineState& state, const DrawCall& call);
// What is wrong with binding a view as a target, if anything.
void validate_view(const TargetView& view, const char* object, Faults& faults);

// Vertices or indices that the draw reads in each instance.
std::int64_t input_count(const DrawCall& call);

}  // namespace nephroid
