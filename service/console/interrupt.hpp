// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::app {

/// From this call on, the first Ctrl-C or SIGTERM only sets a flag (see `interrupted`). A second
/// one, of either kind, ends the program at once.
void watch_for_interrupts();
/// True after a Ctrl-C or SIGTERM arrived.
[[nodiscard]] bool interrupted();

}  // namespace surefoot::app
