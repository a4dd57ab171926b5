#include "mission_bench.hpp"

#include <algorithm>
#include <ctime>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner::bench
{

namespace
{

constexpr int kSurpriseEvery = 10;

double mean(const std::vector<double>& values, std::size_t begin, std::size_t end)
{
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
         static_cast<double>(end - begin);
}

Record record(RecordKind kind, const std::string& statement, bool value, int step)
{
  Record made;
  made.kind = kind;
  made.statement = statement;
  made.value = value;
  made.step = step;
  return made;
}

}  // namespace

nlohmann::json mission(const std::string& domain, const std::string& history, int steps, int window)
{
  ReasonerOptions options;
  options.window = window;
  Reasoner reasoner(readDescription(domain), options);
  reasoner.setHistory(readHistory(history, reasoner.description()));
  const std::vector<std::string>& rooms = reasoner.description().findSort("place")->elements;
  const std::vector<std::string>& books = reasoner.description().findSort("textbook")->elements;
  std::vector<double> milliseconds;
  for (int step = 0; step < steps; ++step)
  {
    const std::string& room = rooms[static_cast<std::size_t>(step) % 2];
    std::vector<Record> records = {
        record(RecordKind::kHappened, "move(rob1, " + room + ")", true, step),
        record(RecordKind::kObserved, "loc(rob1) = " + room, true, step + 1)};
    const auto surprise = static_cast<std::size_t>(step / kSurpriseEvery) % books.size();
    const std::string book = "loc(" + books[surprise] + ") = ";
    if (step % kSurpriseEvery == 0)
    {
      records.push_back(record(RecordKind::kObserved, book + rooms.front(), false, step + 1));
    }
    const std::clock_t start = std::clock();
    reasoner.addRecords(records);
    const bool known = reasoner.entails("loc(rob1) = " + room, step + 1) == Answer::kTrue &&
                       !reasoner.possible(book + rooms.front(), step + 1);
    milliseconds.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    if (!known)
    {
      throw std::logic_error("the reasoner lost what it was told before step " +
                             std::to_string(step + 1));
    }
  }
  const std::size_t part = std::min<std::size_t>(100, milliseconds.size());
  const double first = mean(milliseconds, 0, part);
  const double last = mean(milliseconds, milliseconds.size() - part, milliseconds.size());
  const double all = mean(milliseconds, 0, milliseconds.size());
  return {{"steps", steps},        {"mean_ms", all},
          {"first_ms", first},     {"last_ms", last},
          {"ratio", last / first}, {"records", reasoner.history().size()},
          {"cpu_s", all / 1e3},    {"first_step", reasoner.firstStep()}};
}

}  // namespace kr3::reasoner::bench
