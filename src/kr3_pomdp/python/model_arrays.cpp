#include "model_arrays.hpp"

#include <array>
#include <cstdint>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxDenseEntries = std::size_t{1} << 27U;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::string textOf(const std::vector<std::size_t>& shape)
{
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i)
  {
    text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  }
  return text + "]";
}

/// An array argument: dense, or indices with values.
class ArrayArgument
{
public:
  ArrayArgument(std::string name, const py::object& source) : name_(std::move(name))
  {
    if (py::isinstance<py::dict>(source))
    {
      readDict(source.cast<py::dict>());
    }
    else if (py::isinstance<py::tuple>(source))
    {
      readPair(source.cast<py::tuple>());
    }
    else
    {
      values_ = Doubles::ensure(source);
      if (!values_)
      {
        PyErr_Clear();
        throw InvalidArgument(name_ + ": expected an array of numbers, a pair or a dict");
      }
      dense_ = true;
      shape_.assign(values_.shape(), values_.shape() + values_.ndim());
    }
  }

  [[nodiscard]] bool dense() const { return dense_; }
  [[nodiscard]] std::size_t dimensions() const { return dense_ ? shape_.size() : columns_; }
  /// Of a dense array.
  [[nodiscard]] std::optional<std::size_t> size(std::size_t axis) const
  {
    return dense_ && axis < shape_.size() ? std::optional(shape_[axis]) : std::nullopt;
  }

  /// @throws InvalidArgument  a dense array of another shape, or an index out of it
  template <typename Visit>
  void forEach(const std::vector<std::size_t>& shape, Visit visit) const
  {
    if (dimensions() != shape.size() || (dense_ && shape_ != shape))
    {
      throw InvalidArgument(name_ + ": shape " +
                            (dense_ ? textOf(shape_) : std::to_string(columns_) + " indices") +
                            ", expected " + textOf(shape));
    }
    std::vector<std::size_t> index(shape.size(), 0);
    const auto count = static_cast<std::size_t>(values_.size());
    for (std::size_t i = 0; i < count; ++i)
    {
      const double value = values_.data()[i];
      if (dense_)
      {
        if (value != 0.0)
        {
          unravel(i, shape, index);
          visit(index, value);
        }
        continue;
      }
      for (std::size_t k = 0; k < columns_; ++k)
      {
        const std::int64_t entry = indices_[i * columns_ + k];
        if (entry < 0 || static_cast<std::size_t>(entry) >= shape[k])
        {
          throw InvalidArgument(name_ + ": index " + std::to_string(entry) + " of " +
                                std::to_string(shape[k]) + " in entry " + std::to_string(i));
        }
        index[k] = static_cast<std::size_t>(entry);
      }
      visit(index, value);
    }
  }

private:
  static void unravel(std::size_t flat, const std::vector<std::size_t>& shape,
                      std::vector<std::size_t>& index)
  {
    for (std::size_t k = shape.size(); k-- > 0; flat /= shape[k])
    {
      index[k] = flat % shape[k];
    }
  }

  void readDict(const py::dict& entries)
  {
    std::vector<double> values;
    for (const auto& [key, value] : entries)
    {
      try
      {
        const auto index = key.cast<std::vector<std::int64_t>>();
        columns_ = values.empty() ? index.size() : columns_;
        if (index.size() != columns_)
        {
          throw InvalidArgument(name_ + ": keys of different lengths");
        }
        indices_.insert(indices_.end(), index.begin(), index.end());
        values.push_back(value.cast<double>());
      }
      catch (const py::cast_error&)
      {
        throw InvalidArgument(name_ + ": " + py::repr(key).cast<std::string>() + ": " +
                              py::repr(value).cast<std::string>() +
                              ", expected a tuple of indices and a number");
      }
    }
    values_ = arrayOf(values);
  }

  void readPair(const py::tuple& pair)
  {
    const Integers indices = pair.size() == 2 ? Integers::ensure(pair[0]) : Integers();
    values_ = pair.size() == 2 ? Doubles::ensure(pair[1]) : Doubles();
    if (!indices || !values_ || indices.ndim() != 2 || values_.ndim() != 1 ||
        indices.shape(0) != values_.size())
    {
      PyErr_Clear();
      throw InvalidArgument(name_ +
                            ": expected indices, shape [n, dimensions], and values, "
                            "shape [n]");
    }
    columns_ = static_cast<std::size_t>(indices.shape(1));
    indices_.assign(indices.data(), indices.data() + indices.size());
  }

  std::string name_;
  bool dense_ = false;
  std::vector<std::size_t> shape_;     // of a dense one
  std::size_t columns_ = 0;            // of a sparse one
  std::vector<std::int64_t> indices_;  // row-major, shape [n, columns]
  Doubles values_;
};

std::vector<std::string> named(const NamesArgument& names, const char* kind, char letter,
                               const std::vector<std::optional<std::size_t>>& sizes)
{
  if (names && std::holds_alternative<std::vector<std::string>>(*names))
  {
    return std::get<std::vector<std::string>>(*names);
  }
  std::optional<std::size_t> size;
  if (names)
  {
    size = std::get<std::size_t>(*names);
  }
  for (const std::optional<std::size_t>& other : sizes)
  {
    size = size ? size : other;
  }
  if (!size)
  {
    throw InvalidArgument("how many " + std::string(kind) +
                          " there are is not given: no array is dense");
  }
  std::vector<std::string> made;
  for (std::size_t i = 0; i < *size; ++i)
  {
    made.push_back(letter + std::to_string(i));
  }
  return made;
}

template <typename RowOf>
py::array_t<double> denseOf(const Model& model, std::size_t columns, RowOf row_of)
{
  const std::size_t rows = model.numActions() * model.numStates();
  if (rows > kMaxDenseEntries / columns)
  {
    throw ResourceExhausted("an array of " + std::to_string(rows) + " x " +
                            std::to_string(columns) + " numbers; ask for the entries");
  }
  py::array_t<double> dense({model.numActions(), model.numStates(), columns});
  double* values = dense.mutable_data();
  std::fill(values, values + rows * columns, 0.0);
  for (std::size_t i = 0; i < rows; ++i)
  {
    for (const SparseEntry& entry : row_of(i / model.numStates(), i % model.numStates()))
    {
      values[i * columns + entry.index] = entry.probability;
    }
  }
  return dense;
}

template <typename RowOf>
Entries entriesOf(const Model& model, RowOf row_of)
{
  std::vector<std::int64_t> indices;
  std::vector<double> values;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      for (const SparseEntry& entry : row_of(a, s))
      {
        for (const std::size_t index : {a, s, std::size_t{entry.index}})
        {
          indices.push_back(static_cast<std::int64_t>(index));
        }
        values.push_back(entry.probability);
      }
    }
  }
  return {py::array_t<std::int64_t>({static_cast<py::ssize_t>(values.size()), py::ssize_t{3}},
                                    indices.data()),
          arrayOf(values)};
}

}  // namespace

Model modelFromArrays(const py::object& transitions, const py::object& observations,
                      const py::object& rewards, double discount,
                      const std::optional<BeliefArgument>& initial_belief,
                      const NamesArgument& states, const NamesArgument& actions,
                      const NamesArgument& observation_names, double sum_tolerance)
{
  const ArrayArgument t("transitions", transitions);
  const ArrayArgument o("observations", observations);
  const ArrayArgument r("rewards", rewards);
  ModelBuilder builder(named(states, "states", 's', {t.size(1), o.size(1), r.size(1)}),
                       named(actions, "actions", 'a', {t.size(0), o.size(0), r.size(0)}),
                       named(observation_names, "observations", 'o', {o.size(2), r.size(3)}));
  const std::size_t num_actions = builder.actions().size();
  const std::size_t num_states = builder.states().size();
  const std::size_t num_observations = builder.observations().size();
  builder.setDiscount(discount);
  if (initial_belief)
  {
    builder.setInitialBelief(initial_belief->probabilities);
  }
  t.forEach({num_actions, num_states, num_states},
            [&](const std::vector<std::size_t>& i, double value) {
    builder.addTransition(i[0], i[1], i[2], value);
  });
  o.forEach({num_actions, num_states, num_observations},
            [&](const std::vector<std::size_t>& i, double value) {
    builder.addObservation(i[0], i[1], i[2], value);
  });
  const std::vector<std::size_t> full{num_actions, num_states, num_states, num_observations};
  const std::size_t given = std::min(std::max(r.dimensions(), std::size_t{2}), full.size());
  r.forEach({full.begin(), full.begin() + static_cast<std::ptrdiff_t>(given)},
            [&](const std::vector<std::size_t>& i, double value) {
    builder.setReward(i[0], i[1], i.size() > 2 ? i[2] : kAny, i.size() > 3 ? i[3] : kAny, value);
  });
  return builder.build(sum_tolerance);
}

py::array_t<double> transitionArray(const Model& model)
{
  return denseOf(model, model.numStates(),
                 [&](std::size_t a, std::size_t s) { return model.transitions(a, s); });
}

py::array_t<double> observationArray(const Model& model)
{
  return denseOf(model, model.numObservations(),
                 [&](std::size_t a, std::size_t s) { return model.observations(a, s); });
}

py::array_t<double> rewardArray(const Model& model)
{
  return py::array_t<double>({model.numActions(), model.numStates()}, model.rewards(0));
}

Entries transitionEntries(const Model& model)
{
  return entriesOf(model, [&](std::size_t a, std::size_t s) { return model.transitions(a, s); });
}

Entries observationEntries(const Model& model)
{
  return entriesOf(model, [&](std::size_t a, std::size_t s) { return model.observations(a, s); });
}

}  // namespace kr3::pomdp
