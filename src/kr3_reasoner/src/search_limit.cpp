#include "search_limit.hpp"

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

void SearchLimit::check(const std::string& what) const
{
  if (cancel != nullptr && cancel->load())
  {
    throw Cancelled(std::string(question) + " was cancelled");
  }
  if (isReached())
  {
    throw DeadlineExceeded(std::string(question) + " took longer than its time limit" +
                           (what.empty() ? "" : ", " + what));
  }
}

}  // namespace kr3::reasoner
