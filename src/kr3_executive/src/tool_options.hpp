#pragma once

#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

namespace kr3::executive
{

/// Exit code of our command line tools for options and files that cannot be used.
inline constexpr int kUnusable = 2;

/// Reads the command line and does what it asks for; what goes wrong is told on standard error.
///
/// @param app   with its options
/// @param name  of the tool, for messages
/// @param run   called when the options are right; its result is the exit code
/// @return kUnusable for wrong options and for whatever `run` throws; 0 after --help
inline int runTool(CLI::App& app, const std::string& name, int argc, char** argv,
                   const std::function<int()>& run)
{
  try
  {
    app.parse(argc, argv);
    return run();
  }
  catch (const CLI::ParseError& error)
  {
    return app.exit(error) == 0 ? 0 : kUnusable;
  }
  catch (const std::exception& error)
  {
    std::cout << std::flush;
    std::cerr << name << ": " << error.what() << "\n";
    return kUnusable;
  }
}

}  // namespace kr3::executive
