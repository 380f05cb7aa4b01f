#include "option/program_options.hpp"

namespace dlo::cli {

void add_program_options(CLI::App& command, std::vector<std::string>& programs) {
  command
      .add_option(
          "--with", programs,
          "somebody else's program beside our models: NAME='COMMAND', with {shape} for the "
          "file that it writes, {scene} for the file that it reads (as dlo scene writes it) "
          "and {points} for their number; may be given again")
      ->type_name("NAME=COMMAND")
      ->allow_extra_args(false);
}

}  // namespace dlo::cli
