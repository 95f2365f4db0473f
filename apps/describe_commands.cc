// alidade completion, man-pages and cli-page: the command line for shells, `man` and
// docs/reference/cli.md.
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
#include "describe/markdown_page.h"

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

int PrintMarkdown(const CLI::App& app) {
  const std::string page = MarkdownPage(DescribeCommand(app, "alidade"));
  std::fwrite(page.data(), 1, page.size(), stdout);
  return 0;
}

}  // namespace

void AddDescribeCommands(CLI::App& app, Action& action) {
  CLI::App* completion = app.add_subcommand(
      "completion", "Print a script with which a shell completes commands and options");
  const auto shell = std::make_shared<std::string>();
  completion->add_option("SHELL", *shell, "The shell")->required()->type_name("bash|zsh|fish");
  completion->footer(
      "\nNot needed for an installed program, whose completions are installed with "
      "it.\n\nExamples:\n  source <(alidade completion bash)            for this shell; add it to "
      "~/.bashrc for all\n  source <(alidade completion zsh)             after compinit\n  alidade "
      "completion fish > ~/.config/fish/completions/alidade.fish");
  completion->callback(
      [&app, shell, &action] { action = [&app, shell] { return PrintCompletion(app, *shell); }; });

  CLI::App* pages = app.add_subcommand("man-pages", "Write the manual pages");
  const auto folder = std::make_shared<std::string>();
  pages->add_option("FOLDER", *folder, "Folder to write to")->required()->type_name("FOLDER");
  pages->group("");  // for the build alone
  pages->callback(
      [&app, folder, &action] { action = [&app, folder] { return WriteManPages(app, *folder); }; });

  CLI::App* markdown = app.add_subcommand("cli-page", "Print docs/reference/cli.md");
  markdown->group("");  // for scripts/docs alone
  markdown->callback([&app, &action] { action = [&app] { return PrintMarkdown(app); }; });
}

}  // namespace alidade
