// alidade completion, alidade man-pages: the command line, told to shells and to `man`.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/version.h"
#include "commands.h"
#include "describe/completion.h"
#include "describe/man_page.h"

namespace alidade {
namespace {

using Completion = std::string (*)(const CommandText&);

int PrintCompletion(const CLI::App& app, const std::string& shell) {
  const auto make = Choice<Completion>(
      "SHELL", shell, {{"bash", BashCompletion}, {"zsh", ZshCompletion}, {"fish", FishCompletion}});
  const std::string text = make(DescribeCommand(app, "alidade"));
  std::fwrite(text.data(), 1, text.size(), stdout);
  return 0;
}

int WriteManPages(const CLI::App& app, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const ManPage& page : ManPages(DescribeCommand(app, "alidade"), "alidade " ALIDADE_VERSION))
    AtomicWriteFile(folder + "/" + page.file, page.text);
  return 0;
}

}  // namespace

void AddDescribeCommands(CLI::App& app, Action& action) {
  CLI::App* completion =
      app.add_subcommand("completion", "Print what makes a shell complete commands and options");
  const auto shell = std::make_shared<std::string>();
  completion->add_option("SHELL", *shell, "Which shell")->required()->type_name("bash|zsh|fish");
  completion->footer(
      "\nInstalled programs need none of this: their completions are installed with them.\n"
      "\nExamples:\n"
      "  source <(alidade completion bash)            in this shell; add it to ~/.bashrc to keep\n"
      "  source <(alidade completion zsh)             after compinit\n"
      "  alidade completion fish > ~/.config/fish/completions/alidade.fish");
  completion->callback(
      [&app, shell, &action] { action = [&app, shell] { return PrintCompletion(app, *shell); }; });

  CLI::App* pages = app.add_subcommand("man-pages", "Write the manual pages");
  const auto folder = std::make_shared<std::string>();
  pages->add_option("FOLDER", *folder, "Where to")->required()->type_name("FOLDER");
  pages->group("");  // for the build alone
  pages->callback(
      [&app, folder, &action] { action = [&app, folder] { return WriteManPages(app, *folder); }; });
}

}  // namespace alidade
