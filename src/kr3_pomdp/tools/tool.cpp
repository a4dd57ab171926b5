#include "tool.hpp"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <system_error>

#include <kr3_common/error.hpp>

namespace kr3::pomdp::tool
{

namespace
{

constexpr int kExitInput = 1;
constexpr int kExitUsage = 2;
constexpr int kExitLimit = 3;

}  // namespace

const char* const kExitCodes = R"text(
Exit codes: 0 done; 1 an error in a file or a value, told with its place; 2 wrong usage;
            3 out of memory, or something is too large)text";

int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& run)
{
  app.footer(kExitCodes);
  try
  {
    app.parse(argc, argv);
  }
  catch (const CLI::ParseError& e)
  {
    return app.exit(e) == 0 ? EXIT_SUCCESS : kExitUsage;
  }
  try
  {
    run();
    return EXIT_SUCCESS;
  }
  catch (const kr3::Error& e)
  {
    std::cerr << e.what() << '\n';
    return e.code() == ErrorCode::kResourceExhausted ? kExitLimit : kExitInput;
  }
  catch (const std::bad_alloc&)
  {
    std::cerr << "out of memory\n";
    return kExitLimit;
  }
  catch (const std::exception& e)
  {
    std::cerr << e.what() << '\n';
    return kExitInput;
  }
}

OutputFile::OutputFile(const std::string& path) : path_(path), written_path_(path)
{
  if (path_ == "-")
  {
    return;
  }
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path_, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status))
  {
    written_path_ += ".part";
  }
  file_.open(written_path_, std::ios::binary);
  if (!file_)
  {
    throw Unavailable("cannot write '" + path_ + "'");
  }
}

OutputFile::~OutputFile()
{
  if (!finished_ && written_path_ != path_)
  {
    file_.close();
    std::remove(written_path_.c_str());
  }
}

std::ostream& OutputFile::stream()
{
  return path_ == "-" ? std::cout : file_;
}

void OutputFile::finish()
{
  stream().flush();
  if (path_ != "-")
  {
    file_.close();
  }
  const bool moved =
      written_path_ == path_ || (file_ && std::rename(written_path_.c_str(), path_.c_str()) == 0);
  if (!stream() || !moved)
  {
    throw Unavailable("cannot write '" + path_ + "'");
  }
  finished_ = true;
}

}  // namespace kr3::pomdp::tool
