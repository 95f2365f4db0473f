// Holds draws of random numbers to an order of their own: what a call's arguments, or the two sides
// of an operator, draw is drawn in the order the compiler likes. GCC and clang differ.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string WithoutCommentsAndStrings(const std::string& text) {
  std::string code;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) i = std::min(text.find('\n', i), text.size() - 1);
    const char quote = text[i];
    if (quote == '"' || (quote == '\'' && (i == 0 || !std::isalnum(text[i - 1])))) {
      while (++i < text.size() && text[i] != quote) i += text[i] == '\\';
      code += '0';
      continue;
    }
    code += text[i];
  }
  return code;
}

// Words and single characters.
struct Token {
  std::string text;
  int line;
};
std::vector<Token> Tokens(const std::string& code) {
  std::vector<Token> tokens;
  int line = 1;
  for (size_t i = 0; i < code.size(); ++i) {
    const auto in_word = [&](size_t at) {
      return at < code.size() &&
             (std::isalnum(static_cast<unsigned char>(code[at])) || code[at] == '_');
    };
    line += code[i] == '\n';
    if (std::isspace(static_cast<unsigned char>(code[i]))) continue;
    std::string word(1, code[i]);
    while (in_word(i) && in_word(i + 1)) word += code[++i];
    tokens.push_back({word, line});
  }
  return tokens;
}

// Draws between two brackets, or in the file around them all.
struct Group {
  char bracket = '{';
  bool block = false;   // of statements
  bool head = false;    // of an if or a loop
  int term = 0;         // draws since the last point that orders what is before and after it
  int argument = 0;     // whether the argument drew
  int drawing = 0;      // arguments that drew
  bool passed = false;  // the generator itself is an argument: the call draws
  bool drew = false;

  void EndTerm() { term = 0; }
  void EndArgument() {
    drawing += argument;
    argument = 0;
    EndTerm();
  }
};

// Lines in which the order of two draws is left open. A draw is `random.X(…)`, `random().X(…)`, or
// a call with `random` among its arguments. Braces, `;`, `?:`, && and || keep to their order.
std::vector<int> OpenDraws(const std::string& text) {
  const std::vector<Token> tokens = Tokens(WithoutCommentsAndStrings(text));
  std::vector<int> lines;
  std::vector<Group> open(1);
  const auto draw = [&](int line) {
    Group& group = open.back();
    group.argument = 1;
    group.drew = true;
    if (++group.term == 2) lines.push_back(line);
  };
  for (size_t i = 0; i < tokens.size(); ++i) {
    const std::string& token = tokens[i].text;
    const auto next = [&](size_t n) { return i + n < tokens.size() ? tokens[i + n].text : ""; };
    if (token == "(" || token == "{" || token == "[") {
      const std::string before = i > 0 ? tokens[i - 1].text : "";
      Group group;
      group.bracket = token[0];
      group.head = before == "if" || before == "for" || before == "while" || before == "switch";
      open.push_back(group);
    } else if (token == ")" || token == "}" || token == "]") {
      if (open.size() == 1) continue;
      Group group = open.back();
      group.EndArgument();
      open.pop_back();
      if (group.bracket == '(' && group.drawing > 1 && !group.block)
        lines.push_back(tokens[i].line);
      if ((group.bracket == '{' && group.block) || group.head) {
        open.back().EndArgument();  // a statement ends, or begins
      } else if (group.drew || group.passed) {
        draw(tokens[i].line);
      }
    } else if (token == ";") {
      open.back().block = true;
      open.back().EndArgument();
      open.back().drawing = 0;
    } else if (token == ",") {
      open.back().EndArgument();
    } else if (token == "?" || token == ":" || token == "=" || token == "return" ||
               ((token == "&" || token == "|") && next(1) == token)) {
      open.back().EndTerm();
    } else if (token == "random") {
      const std::string before = i > 0 ? tokens[i - 1].text : "";
      if ((before == "(" || before == ",") && (next(1) == "," || next(1) == ")")) {
        open.back().passed = true;
      } else if (next(1) == "." || (next(1) == "(" && next(2) == ")" && next(3) == ".")) {
        draw(tokens[i].line);
      }
    }
  }
  return lines;
}

TEST(RandomDraws, TheRuleFindsWhatItIsFor) {
  const auto found = [](const char* code) { return static_cast<int>(OpenDraws(code).size()); };
  EXPECT_EQ(found("f(random.Below(2), random.Below(3));"), 1);
  EXPECT_EQ(found("f(Pick(random, 1, 2),\n Pick(random, 1, 3));"), 1);
  EXPECT_EQ(found("const Rect r(random().Uniform(), 2, random().Uniform());"), 1);
  EXPECT_EQ(found("x = 3 * Noise(random, 1) + 4 * Noise(random, 2);"), 1);
  EXPECT_EQ(found("f({x, random.Below(2)}, g(random));"), 1);
  EXPECT_EQ(found("x = random.Uniform() * (random.Uniform() < 0.5 ? 1 : -1);"), 1);

  EXPECT_EQ(found("f(random.Below(2)); g(random.Below(3));"), 0);
  EXPECT_EQ(found("const double x = random.Uniform(), y = random.Uniform();"), 0);
  EXPECT_EQ(found("return {random.Below(2), random.Below(3)};"), 0);
  EXPECT_EQ(found("f({random.Below(2), random.Below(3)}, 4);"), 0);
  EXPECT_EQ(found("x = random.Uniform() < 0.5 ? random.Uniform(1, 2) : random.Uniform(3, 4);"), 0);
  EXPECT_EQ(found("f(random, picture, Pick(random, 1, 2));"), 0);
  EXPECT_EQ(found("for (int i = random.Below(3); i > 0; i -= random.Below(2)) f(random.Next());"),
            0);
  EXPECT_EQ(found("if (random.Uniform() < 0.6) f(random.Uniform());"), 0);
  EXPECT_EQ(found("f([&] { g(random.Next()); h(random.Next()); }, 3);"), 0);
  EXPECT_EQ(found("double F(Random& random, double x); // random.Next() + random.Next()"), 0);
}

TEST(RandomDraws, NoSourceLeavesTheirOrderToTheCompiler) {
  int files = 0;
  for (const char* folder : {"src", "apps", "bench"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(ALIDADE_SOURCE_DIR) / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cc" && extension != ".h") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      for (const int line : OpenDraws(text.str())) {
        ADD_FAILURE() << entry.path().string() << ":" << line
                      << ": two random numbers drawn in an order that is the compiler's";
      }
      ++files;
    }
  }
  EXPECT_GT(files, 100);
}

}  // namespace
