#pragma once

#include <string>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/component_map.hpp"

namespace kr3::refinement
{

/// What several loaders refuse, so that one run tells all that is wrong with the files of a domain.
/// Not thread-safe.
class Refusals
{
public:
  /// Runs a loader and keeps its message when it refuses a file.
  /// @return whether it did not refuse
  /// Errors other than InvalidArgument, such as a missing file, go through.
  template <typename Load>
  bool attempt(const Load& load)
  {
    try
    {
      load();
      return true;
    }
    catch (const InvalidArgument& error)
    {
      text_ += (text_.empty() ? "" : "\n") + std::string(error.what());
      return false;
    }
  }

  [[nodiscard]] bool empty() const { return text_.empty(); }

  /// @throws InvalidArgument  all messages, in the order of the attempts
  void throwIfAny() const
  {
    if (!text_.empty())
    {
      throw InvalidArgument(text_);
    }
  }

private:
  std::string text_;
};

/// reasoner::parseRefinement, with a way out added to what users of refinements get wrong: fluents
/// of the theory of observations, which is made from the refinement and is no part of it, and
/// wholes in the place of their components.
///
/// @throws InvalidArgument  as reasoner::parseRefinement
[[nodiscard]] reasoner::Description parseRefinementText(const std::string& text,
                                                        const std::string& file,
                                                        const reasoner::Description& high_level);

/// The same from a file. @throws Unavailable  it cannot be read
[[nodiscard]] reasoner::Description readRefinementFile(const std::string& path,
                                                       const reasoner::Description& high_level);

/// The names of the low level without the checks of LowLevelDomain: enough to check models and
/// bindings while a refinement or its map is refused. Axioms of the high level are not read over
/// components, so nothing else may be done with it.
[[nodiscard]] reasoner::Description namesOfLowLevel(const reasoner::Description& high_level,
                                                    const reasoner::Description& refinement,
                                                    const ComponentMap& map);

}  // namespace kr3::refinement
