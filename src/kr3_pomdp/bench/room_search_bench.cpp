// Bounds on the room search family after so many CPU seconds.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace
{

double cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void solveRoom(std::size_t width, double most_s)
{
  const kr3::pomdp::Model model = kr3::pomdp::test::roomSearch(width);
  const std::vector<double> times{0.05, 0.1, 0.5, 1.0, 5.0, 10.0, 20.0, 60.0};
  std::size_t next = 0;
  const double start = cpuSeconds();
  kr3::pomdp::SolverLimits limits;
  (void)kr3::pomdp::solve(model, limits, [&](const kr3::pomdp::SolverProgress& progress) {
    const double elapsed_s = cpuSeconds() - start;
    while (next < times.size() && elapsed_s >= times[next])
    {
      std::printf("%5zu cells  %6.2f s CPU  [%8.3f, %8.3f]  %8llu backups  %7zu vectors\n",
                  width * width, times[next], progress.lower, progress.upper,
                  static_cast<unsigned long long>(progress.backups), progress.num_alpha_vectors);
      std::fflush(stdout);
      ++next;
    }
    return elapsed_s < most_s;
  });
}

}  // namespace

/// Usage: room_search_bench [seconds for each size, 10]
int main(int argc, char** argv)
{
  const double most_s = argc > 1 ? std::atof(argv[1]) : 10.0;
  for (const std::size_t width : {2U, 3U, 4U, 5U})
  {
    solveRoom(width, most_s + 1e-3);
  }
  return EXIT_SUCCESS;
}
