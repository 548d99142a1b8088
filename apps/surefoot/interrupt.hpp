// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::app {

/// From here on Ctrl-C and SIGTERM are remembered instead of ending the program; a second one ends
/// it at once.
void watch_for_interrupts();
/// True once one came.
[[nodiscard]] bool interrupted();

}  // namespace surefoot::app
