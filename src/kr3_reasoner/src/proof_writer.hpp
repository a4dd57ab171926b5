#pragma once

#include <set>
#include <string>
#include <vector>

#include "history_theory.hpp"

namespace kr3::reasoner
{

/// What a proof rests on.
struct Leaves
{
  std::set<std::size_t> records;
  std::set<std::string> defaults;  ///< ground
  std::set<std::size_t> assumed;   ///< indices into the world's assumptions
  std::set<std::size_t> laws;
};

/// Turns inferences into proof trees with sentences. Private to the package.
class ProofWriter
{
public:
  /// All must outlive this object.
  ProofWriter(const HistoryTheory& theory, const Words& words, const InitialWorld& world,
              const std::vector<CheckedRecord>& records)
    : theory_(theory), words_(words), world_(world), records_(records)
  {
  }

  /// The proof of an inference, as it is used at a step. What was shown before is not shown again.
  [[nodiscard]] Reason written(int inference, int step);

  /// What a contradiction comes from.
  [[nodiscard]] std::vector<Reason> contradiction(int inference);

  [[nodiscard]] Leaves leaves(int inference) const;

private:
  [[nodiscard]] std::vector<Reason> flattened(int inference, int step);
  [[nodiscard]] std::vector<Reason> children(const Inference& inference);
  [[nodiscard]] Reason node(int number, const Inference& inference);
  [[nodiscard]] Reason leaf(const Inference& inference, const ClauseOrigin& origin) const;
  [[nodiscard]] bool collapse(const Inference& inference, Reason& reason);
  [[nodiscard]] int resolved(int inference) const;
  void describe(Reason& reason, const ClauseOrigin& origin) const;

  const HistoryTheory& theory_;
  const Words& words_;
  const InitialWorld& world_;
  const std::vector<CheckedRecord>& records_;
  std::set<int> shown_;
};

}  // namespace kr3::reasoner
