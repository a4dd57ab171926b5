#include <kr3_common/python/errors.hpp>

#include "bindings.hpp"

PYBIND11_MODULE(kr3_reasoner, module)
{
  module.doc() =
      "High-level reasoning of KR3: an action language, histories with defaults, entailment, "
      "diagnosis and planning. Names are those of the C++ library; statements are texts in the "
      "language.";
  kr3::bindErrors(module);
  kr3::reasoner::bindLanguage(module);
  kr3::reasoner::bindAnswers(module);
  kr3::reasoner::bindPlans(module);
  kr3::reasoner::bindReasoner(module);
}
