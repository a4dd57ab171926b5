#pragma once

#include "step_body.hpp"

namespace kr3::reasoner
{

// The parts of a StepProgram, each added to the program of its context.

void groundPrices(const StepContext& context);
void groundExecutability(const StepContext& context, const Executability& rule);

/// Actions that may not occur together.
void groundExclusion(const StepContext& context, const Executability& rule);

/// @param index  of the law in the description
void groundLaw(const StepContext& context, const CausalLaw& law, std::size_t index);

void watchCircular(const StepContext& context);
void groundConstraints(const StepContext& context);

}  // namespace kr3::reasoner
