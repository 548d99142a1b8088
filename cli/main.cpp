// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <string>

#include "cli/command_line.hpp"
#include "service/console/log.hpp"
#include "service/console/options.hpp"

int main(int argc, char** argv) {
    try {
        return surefoot::app::run_command_line(argc, argv);
    } catch (const std::exception& error) {
        surefoot::app::log_error(std::string("internal error: ") + error.what());
        return surefoot::app::kExitFailed;
    }
}
