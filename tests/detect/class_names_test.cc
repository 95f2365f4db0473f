#include "alidade/detect/class_names.h"

#include <gtest/gtest.h>

namespace alidade::class_names_test {
namespace {

using Names = std::vector<std::string>;

TEST(ClassNames, AreReadFromListsAndTables) {
  EXPECT_EQ(ParseClassNames("['person', 'traffic light']"), (Names{"person", "traffic light"}));
  EXPECT_EQ(ParseClassNames("{0: 'person', 1: 'cat'}"), (Names{"person", "cat"}));
  EXPECT_EQ(ParseClassNames("{2: 'cat', 0: 'dog'}"), (Names{"dog", "", "cat"}));
  EXPECT_EQ(ParseClassNames(R"(["dog's bed", 'a "b"', 'it\'s',])"),
            (Names{"dog's bed", "a \"b\"", "it's"}));
  EXPECT_EQ(ParseClassNames("[]"), Names{});
}

TEST(ClassNames, AreNoneInAnythingElse) {
  for (const char* text : {"", "person", "['person'", "{0 'person'}", "{'a': 'b'}", "[1, 2]", "['a",
                           "{99999999999: 'a'}", "['a\\", "{0:"})
    EXPECT_EQ(ParseClassNames(text), Names{}) << text;
}

TEST(ClassNames, AreCocosForEightyClasses) {
  const Names names = NamesFor(80, {});
  EXPECT_EQ(names.size(), 80u);
  EXPECT_EQ(names[0], "person");
  EXPECT_EQ(names[56], "chair");
  EXPECT_EQ(names[79], "toothbrush");
  EXPECT_EQ(NamesFor(0, {}).size(), 80u);
}

TEST(ClassNames, AreNumbersWhenNobodySays) {
  EXPECT_EQ(NamesFor(2, {}), (Names{"class 0", "class 1"}));
  EXPECT_EQ(NamesFor(3, {"a", "", "c"}), (Names{"a", "class 1", "c"}));
  EXPECT_EQ(NamesFor(1, {"a", "b"}), Names{"a"});
  EXPECT_EQ(NamesFor(80, {"robot"})[56], "class 56");
}

TEST(ClassNames, AreListedWhole) {
  const std::string list = "cat,cell phone,chair";
  for (const char* name : {"cat", "cell phone", "chair"}) EXPECT_TRUE(IsListed(list, name)) << name;
  for (const char* name : {"ca", "at", "phone", "chairlift"})
    EXPECT_FALSE(IsListed(list, name)) << name;
  EXPECT_TRUE(IsListed("cat", "cat"));
  EXPECT_FALSE(IsListed("", "cat"));
}

}  // namespace
}  // namespace alidade::class_names_test
