#include "kr3_executive/history_window.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

void HistoryWindow::reset(std::vector<reasoner::Record> records)
{
  all_ = std::move(records);
  first_step_ = 0;
}

void HistoryWindow::add(const std::vector<reasoner::Record>& records)
{
  all_.insert(all_.end(), records.begin(), records.end());
}

std::optional<int> HistoryWindow::due() const
{
  const int now = currentStep(all_);
  if (steps_ == 0 || now - first_step_ <= steps_ + steps_ / 2)
    return std::nullopt;
  return now - steps_;
}

std::vector<std::size_t> HistoryWindow::amongAll(const std::vector<std::size_t>& kept) const
{
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < all_.size(); ++i)
  {
    if (all_[i].step >= first_step_)
      indices.push_back(i);
  }
  std::vector<std::size_t> result;
  for (const std::size_t index : kept)
  {
    if (index >= indices.size())
    {
      throw InternalError("record " + std::to_string(index) + " of " +
                          std::to_string(indices.size()) + " that are kept");
    }
    result.push_back(indices[index]);
  }
  return result;
}

}  // namespace kr3::executive
