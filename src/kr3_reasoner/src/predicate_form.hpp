#pragma once

#include <vector>

#include "builder.hpp"
#include "kr3_reasoner/language.hpp"

/// The predicate form of functional fluents: `inertial loc(thing, place).` with the exclusion law
/// `-loc(T, P1) if loc(T, P2), P1 != P2.` (Zhang et al. 2014, sec. "HL domain representation").
/// Private to the package.
///
/// A complete state may falsify every `loc(t, p)` of a thing, since the exclusion law says "at most
/// one" only. So the fluent is a partial function: `loc(thing)` with the values of `place` and one
/// more, for "no value". `loc(T, P)` is then `loc(T) = P` with P a place, and `-loc(T, P)` is
/// `loc(T) != P`. With `total loc.` every state has a value, and no further one is added.
///
/// The two descriptions have the same states and transitions when no causal law has an effect
/// `-loc(...)` and (unless total) no other constraint has a head `-loc(...)`: such a law takes a
/// value away without giving another, which a functional literal cannot say. Where one does, the
/// fluent stays boolean, as it is written.
namespace kr3::reasoner
{

/// Rewrites all fluents that are in the predicate form, with every literal about them, those of
/// `base` included.
///
/// @param base  the description that `description` refines, or nullptr
/// @param totalities  the `total` statements; a wrong one is reported
void rewritePredicateForm(Description& description, const Description* base,
                          const std::vector<Totality>& totalities,
                          std::vector<Diagnostic>& problems);

/// Turns `loc(T, P)` into `loc(T) = P` when the description has loc in the predicate form.
/// Any other literal stays.
void makeFunctional(Literal& literal, const Description& description);

}  // namespace kr3::reasoner
