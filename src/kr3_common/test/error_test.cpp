#include "kr3_common/error.hpp"

#include <cstring>

#include <gtest/gtest.h>

namespace kr3
{
namespace
{

TEST(Error, KeepsCodeMessageAndCallersPlace)
{
  try
  {
    throw InvalidArgument("observation 9 of 3");
  }
  catch (const Error& e)
  {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidArgument);
    EXPECT_STREQ(e.what(), "observation 9 of 3");
    EXPECT_NE(std::strstr(e.where().file, "error_test.cpp"), nullptr);
    EXPECT_GT(e.where().line, 0);
  }
}

TEST(Error, LeavesAreCaughtByTheirOwnTypeOnly)
{
  EXPECT_THROW(throw NotFound("policy p1"), NotFound);
  try
  {
    throw NotFound("policy p1");
  }
  catch (const InvalidArgument&)
  {
    FAIL() << "a NotFound is no InvalidArgument";
  }
  catch (const Error& e)
  {
    EXPECT_EQ(e.code(), ErrorCode::kNotFound);
  }
}

TEST(ErrorCode, EveryCodeHasItsOwnName)
{
  for (int a = 0; a <= static_cast<int>(ErrorCode::kInternal); ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_STRNE(toString(static_cast<ErrorCode>(a)), toString(static_cast<ErrorCode>(b)));
}

}  // namespace
}  // namespace kr3
