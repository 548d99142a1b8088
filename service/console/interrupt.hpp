// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::app {

/// After this call, the first Ctrl-C or SIGTERM only sets a flag (see `interrupted`). A second
/// Ctrl-C or SIGTERM ends the program at once.
void watch_for_interrupts();
/// Returns true after a Ctrl-C or SIGTERM arrived.
[[nodiscard]] bool interrupted();

}  // namespace surefoot::app
