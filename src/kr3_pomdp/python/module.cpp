#include <kr3_common/python/errors.hpp>

#include "bindings.hpp"

PYBIND11_MODULE(kr3_pomdp, module)
{
  module.doc() =
      "Decisions under uncertainty: POMDP models, beliefs, policies, a solver with lower and upper "
      "bounds, and planning online. Names are those of the C++ library; states, actions and "
      "observations are given by index or name; arrays are numpy's.";
  kr3::bindErrors(module);
  kr3::pomdp::bindBeliefs(module);
  kr3::pomdp::bindModels(module);
  kr3::pomdp::bindFactoredModels(module);
  kr3::pomdp::bindPolicies(module);
  kr3::pomdp::bindSolving(module);
  kr3::pomdp::bindExactSolver(module);
  kr3::pomdp::bindPlanning(module);
}
