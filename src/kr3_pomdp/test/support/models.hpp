#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp::test
{

/// Two doors, a tiger behind one. Source: Cassandra, Kaelbling and Littman (1994).
[[nodiscard]] Model tiger(double discount = 0.95);

/// Search of a room of width * width cells for an object that is in one of them or elsewhere; the
/// robot's cell is observed after each move. It may grasp the object, or finish without it.
[[nodiscard]] Model roomSearch(std::size_t width);

/// Cheese maze: eleven cells, walls are seen, the start is drawn anew at the cheese; discount 0.95.
/// Source: McCallum (1993), in the numbers of Cassandra's collection.
[[nodiscard]] Model cheese();

/// The 4x3 maze with a treasure and a trap, in which walls to the left and right are seen; the
/// start is drawn anew from both; discount 0.95. Source: Parr and Russell (1995), in the numbers of
/// Cassandra's collection.
[[nodiscard]] Model maze4x3();

/// A shuttle that docks backwards at two space stations in turn; discount 0.95.
/// Source: Chrisman (1992), in the numbers of Cassandra's collection.
[[nodiscard]] Model shuttle();

struct RandomShape
{
  std::size_t num_states = 3;
  std::size_t num_actions = 2;
  std::size_t num_observations = 2;
  double discount = 0.6;
  double zeros = 0.3;            ///< part of the entries of T and O that are 0
  bool deterministic = false;    ///< every row of T has one entry
  std::size_t num_classes = 1;   ///< the observation tells the state modulo this for certain
  bool absorbing = false;        ///< the last state is never left and earns nothing
  bool labelled = false;         ///< the state modulo 2 is seen before the first action
  bool outcome_rewards = false;  ///< rewards depend on the next state and the observation
  double least_reward = -1.0;
  double greatest_reward = 1.0;
};

/// Some zeros in every table.
[[nodiscard]] Model randomModel(const RandomShape& shape, std::uint64_t seed);

/// A shape of two to five states in which each feature comes up with some seeds.
[[nodiscard]] RandomShape randomShape(std::uint64_t seed);

/// What a shape is, for messages.
[[nodiscard]] std::string toString(const RandomShape& shape);

/// A small search with random numbers: something stays at one of two or three places (in some
/// models it seldom moves), sensors that tell where it is are noisy, and it may be taken or given
/// up.
[[nodiscard]] Model randomSearch(std::uint64_t seed);

/// A belief over `num_states` states, at times on the border of the simplex.
[[nodiscard]] Belief randomBelief(std::size_t num_states, std::mt19937_64& random);

/// Limits of a run of counted work.
[[nodiscard]] SolverLimits backups(std::uint64_t count, double precision = 0.0);

/// The same model with another discount.
[[nodiscard]] Model withDiscount(const Model& model, double discount);

/// The parts that make the same model again.
[[nodiscard]] ModelParts partsOf(const Model& model);

/// The model with something that is seen before the first action.
/// @param labels  shape [num_states]
[[nodiscard]] Model withLabels(const Model& model, std::vector<std::uint32_t> labels);

}  // namespace kr3::pomdp::test
