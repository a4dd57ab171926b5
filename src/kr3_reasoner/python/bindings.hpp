#pragma once

#include <string>
#include <vector>

#include <pybind11/chrono.h>
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "kr3_reasoner/reasoner.hpp"

/// The Python module kr3_reasoner: names are those of the C++ library. One function a part of it;
/// each binds the types that later ones use.
namespace kr3::reasoner
{

/// Descriptions, records and how they are read.
void bindLanguage(pybind11::module_& module);
/// Diagnoses, retractions, models and explanations.
void bindAnswers(pybind11::module_& module);
/// Plans and relevance.
void bindPlans(pybind11::module_& module);
/// Reasoner and ReasonerOptions.
void bindReasoner(pybind11::module_& module);

/// A model of a history with the description that says how literals are written.
struct PrintedModel
{
  std::vector<std::string> assumed;
  std::vector<std::vector<std::string>> states;
  std::vector<std::vector<std::string>> actions;
  int first_step;
};

}  // namespace kr3::reasoner
