#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

class Symbols;

/// Parses ground literals of one description, each text once: the same few are asked about again
/// and again. Not thread-safe.
class GroundLiterals
{
public:
  /// @param description  must outlive this
  explicit GroundLiterals(const Description& description);
  ~GroundLiterals();
  GroundLiterals(const GroundLiterals&) = delete;
  GroundLiterals& operator=(const GroundLiterals&) = delete;

  /// @throws InvalidArgument  as parseGroundLiteral
  [[nodiscard]] const Literal& of(const std::string& text);

private:
  std::unique_ptr<const Symbols> symbols_;
  std::unordered_map<std::string, Literal> known_;
};

}  // namespace kr3::reasoner
