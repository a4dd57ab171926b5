#include "text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <utility>

namespace kr3::reasoner
{

namespace
{

constexpr std::array<const char*, 11> kSections = {
    "sorts",    "statics", "fluents", "actions",   "axioms",        "observations",
    "defaults", "facts",   "asp",     "asp state", "asp transition"};

bool isDigit(char c)
{
  return c >= '0' && c <= '9';
}

bool isWordCharacter(char c)
{
  return isDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool isBlank(char c)
{
  return c == ' ' || c == '\t';
}

bool isSpace(char c)
{
  return isBlank(c) || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

/// Length of the UTF-8 character that `text` begins with; 0 when it is none.
std::size_t characterLength(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80)
  {
    return 1;
  }
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length)
  {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i)
  {
    if (byte(i) < 0x80 || byte(i) >= 0xC0)
    {
      return 0;
    }
  }
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool surrogate = first == 0xED && byte(1) >= 0xA0;
  const bool above = first == 0xF4 && byte(1) >= 0x90;
  return overlong || surrogate || above ? 0 : length;
}

std::string hexadecimal(char c)
{
  std::array<char, 8> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "0x%02x", static_cast<unsigned char>(c));
  return buffer.data();
}

/// Walks over a text once, counting lines and columns.
class Splitter
{
public:
  explicit Splitter(std::string_view text) : text_(text) {}

  std::vector<Chunk> run()
  {
    while (!atEnd())
    {
      if (isSpace(text_[at_]))
      {
        step();
      }
      else if (text_[at_] == '%')
      {
        skipLine();
      }
      else if (const char* header = headerHere())
      {
        section_ = header;
        skipLine();
        if (isAspSection(section_))
        {
          takeAsp();
        }
      }
      else
      {
        takeStatement();
      }
    }
    return std::move(chunks_);
  }

private:
  [[nodiscard]] bool atEnd() const { return at_ >= text_.size(); }

  [[nodiscard]] char peek(std::size_t ahead) const
  {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  void step()
  {
    if (text_[at_] == '\n')
    {
      ++line_;
      column_ = 1;
    }
    else
    {
      ++column_;
    }
    ++at_;
  }

  void skipLine()
  {
    while (!atEnd() && text_[at_] != '\n')
    {
      step();
    }
  }

  /// The section whose header stands here, followed by nothing but blanks or a comment up to the
  /// end of the line; nullptr when there is none.
  [[nodiscard]] const char* headerHere() const
  {
    constexpr std::size_t kLongest = 40;  // with some blanks between the words
    std::string words;
    std::size_t i = at_;
    for (;
         i < text_.size() && i - at_ < kLongest && (isWordCharacter(text_[i]) || isBlank(text_[i]));
         ++i)
    {
      if (!isBlank(text_[i]) || (!words.empty() && words.back() != ' '))
      {
        words += isBlank(text_[i]) ? ' ' : text_[i];
      }
    }
    while (i < text_.size() && isBlank(text_[i]))
    {
      ++i;
    }
    if (i < text_.size() && text_[i] != '\n' && text_[i] != '\r' && text_[i] != '%')
    {
      return nullptr;
    }
    words.erase(words.find_last_not_of(' ') + 1);
    const auto found = std::find(kSections.begin(), kSections.end(), words);
    return found == kSections.end() ? nullptr : *found;
  }

  /// Steps over the end of a line and the blanks after it; whether a section begins there.
  [[nodiscard]] bool stepToHeader()
  {
    step();
    while (!atEnd() && isBlank(text_[at_]))
    {
      step();
    }
    return !atEnd() && headerHere() != nullptr;
  }

  void takeStatement()
  {
    const std::size_t begin = at_;
    Chunk chunk{section_, {}, line_, column_};
    std::size_t end = at_;
    bool done = false;
    while (!done && !atEnd())
    {
      const char c = text_[at_];
      if (c == '%')
      {
        skipLine();
        end = at_;
      }
      else if (c == '\n')
      {
        done = stepToHeader();
        end = done ? end : at_;
      }
      else if (c == '.' && peek(1) == '.')
      {
        step();
        step();
        end = at_;
      }
      else
      {
        const bool decimal = c == '.' && at_ > begin && isDigit(text_[at_ - 1]) && isDigit(peek(1));
        done = c == '.' && !decimal;
        step();
        end = at_;
      }
    }
    chunk.text = text_.substr(begin, end - begin);
    chunks_.push_back(std::move(chunk));
  }

  void takeAsp()
  {
    const std::size_t begin = at_;
    Chunk chunk{section_, {}, line_, column_};
    std::size_t end = at_;
    while (!atEnd())
    {
      end = at_;
      if (text_[at_] != '\n')
      {
        skipLine();
        end = at_;
      }
      if (!atEnd() && stepToHeader())
      {
        break;
      }
      end = at_;
    }
    chunk.text = text_.substr(begin, end - begin);
    chunks_.push_back(std::move(chunk));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  int column_ = 1;
  std::string section_;
  std::vector<Chunk> chunks_;
};

}  // namespace

bool isAspSection(const std::string& section)
{
  return section == "asp" || section == "asp state" || section == "asp transition";
}

std::vector<Chunk> split(std::string_view text)
{
  return Splitter(text).run();
}

void checkBytes(std::string_view text, const std::string& file, std::vector<Diagnostic>& problems)
{
  int line = 1;
  int column = 1;
  for (std::size_t i = 0; i < text.size();)
  {
    const char c = text[i];
    const std::size_t length = characterLength(text.substr(i, 4));
    const bool control = (static_cast<unsigned char>(c) < 0x20 && !isSpace(c)) || c == 0x7F;
    if (length == 0)
    {
      problems.push_back(
          {{file, line, column}, "found the byte " + hexadecimal(c) + ", expected UTF-8"});
    }
    else if (control)
    {
      problems.push_back(
          {{file, line, column},
           "found " + (c == '\0' ? "a NUL byte" : "the control character " + hexadecimal(c)) +
               ", expected text"});
    }
    const std::size_t taken = std::max<std::size_t>(length, 1);
    line += c == '\n' ? 1 : 0;
    column = c == '\n' ? 1 : column + static_cast<int>(taken);
    i += taken;
  }
}

std::string quotedWord(std::string_view text)
{
  constexpr std::size_t kLongest = 60;
  if (text.empty())
  {
    return "the end";
  }
  if (!isWordCharacter(text[0]))
  {
    const std::size_t length = characterLength(text.substr(0, 4));
    const bool printable = length > 1 || (text[0] > ' ' && text[0] < 0x7F);
    return printable ? "'" + std::string(text.substr(0, length)) + "'" : hexadecimal(text[0]);
  }
  const auto end = std::find_if_not(text.begin(), text.end(), isWordCharacter);
  const auto length = static_cast<std::size_t>(end - text.begin());
  return length <= kLongest ? "'" + std::string(text.substr(0, length)) + "'"
                            : "'" + std::string(text.substr(0, kLongest)) + "...'";
}

}  // namespace kr3::reasoner
