#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_common/error.hpp"

/// For tests of readers: files that nobody should write. A reader either takes a damaged file or
/// refuses it with an error of ours. KR3_DAMAGE_CASES (so many times more cases) and
/// KR3_DAMAGE_SEED (the first seed, 1 by default) are for long runs, with sanitizers.
namespace kr3::test_support
{

/// A whole number from the environment.
inline std::size_t environmentNumber(const char* name, std::size_t otherwise)
{
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

inline std::string contentOf(const std::filesystem::path& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write(const std::filesystem::path& path, const std::string& content)
{
  std::ofstream(path, std::ios::binary) << content;
}

/// The content with one to three damages: to bytes, words, numbers, lines, its end.
inline std::string damaged(std::string text, std::mt19937_64& random)
{
  static const std::vector<std::string> kWords = {
      "-1",          "0",          "1e999",       "nan",   ".Nan",  ".Inf",
      "99999999999", "2147483647", "-2147483648", "65536", "3.7",   "1e300",
      "1e-300",      "9999",       "0.001",       "\"x\"", "[",     "]",
      "{",           "}",          ":",           ",",     "\"",    "null",
      "~",           "u",          "d",           "f",     "%YAML", "!!opencv-matrix",
      "\n",          "\xff",       "...",         "---",   "&a *a", "<<"};
  const std::size_t num_damages = 1 + random() % 3;
  for (std::size_t i = 0; i < num_damages && !text.empty(); ++i)
  {
    // Half of the damages go where names of values are, which are rare in files full of numbers.
    std::size_t at = random() % text.size();
    if (random() % 2 == 0)
      at = std::min(text.find(random() % 2 == 0 ? ':' : '"', at), text.size() - 1);
    const std::size_t length = std::min<std::size_t>(1 + random() % 8, text.size() - at);
    const std::string& word = kWords[random() % kWords.size()];
    switch (random() % 8)
    {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, word);
        break;
      case 3:
        text.replace(at, length, word);
        break;
      case 4:
        if (random() % 4 == 0)
          text.resize(at);
        break;
      case 5:  // a part again
        text.insert(random() % text.size(), text.substr(at, 40));
        break;
      default:  // another number
      {
        const std::size_t begin = text.find_first_of("0123456789", at);
        if (begin == std::string::npos)
          break;
        const std::size_t end = text.find_first_not_of("0123456789.e+-", begin);
        text.replace(begin, (end == std::string::npos ? text.size() : end) - begin, word);
      }
    }
  }
  return text;
}

/// Runs `use`, which may throw an error of ours and nothing else.
/// @param what     named in a failure of the test
/// @param message  must occur in the error, such as the name of the file
/// @return whether it went through
inline bool takes(const std::function<void()>& use, const std::string& what,
                  const std::string& message = "")
{
  constexpr std::size_t kLeastMessage = 10;
  try
  {
    use();
    return true;
  }
  catch (const Error& e)
  {
    const std::string error = e.what();
    EXPECT_GT(error.size(), kLeastMessage) << what;
    EXPECT_NE(error.find(message), std::string::npos) << what << ": " << error;
  }
  catch (const std::exception& e)
  {
    ADD_FAILURE() << what << ": " << e.what();
  }
  return false;
}

/// Damages `file` in `cases` ways, calls `use` each time, and leaves the file as it was. The sound
/// file must be taken, and of the damaged ones at least one refused.
/// @param message  see takes()
/// @return how many of the damaged ones were taken
inline std::size_t damageFile(const std::filesystem::path& file, std::size_t cases,
                              const std::function<void()>& use, const std::string& message = "")
{
  const std::string sound = contentOf(file);
  EXPECT_FALSE(sound.empty()) << file;
  EXPECT_TRUE(takes(use, "undamaged"));
  const std::size_t num_cases = cases * environmentNumber("KR3_DAMAGE_CASES", 1);
  const std::size_t first = environmentNumber("KR3_DAMAGE_SEED", 1);
  std::size_t taken = 0;
  for (std::size_t seed = first; seed < first + num_cases; ++seed)
  {
    std::mt19937_64 random(seed);
    write(file, damaged(sound, random));
    const std::string what = file.filename().string() + ", seed " + std::to_string(seed);
    taken += takes(use, what, message) ? 1 : 0;
  }
  for (const std::string& content : {std::string(), sound.substr(0, sound.size() / 2)})
  {
    write(file, content);
    (void)takes(use, file.filename().string() + " of " + std::to_string(content.size()) + " bytes",
                message);
  }
  write(file, sound);
  EXPECT_LT(taken, num_cases);
  return taken;
}

}  // namespace kr3::test_support
