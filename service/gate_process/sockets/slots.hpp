// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace surefoot::gate_process {

/// How many connections a service keeps, and for whom.
struct SlotLimits {
    std::size_t max_clients = 64;
    std::size_t reserved = 8;  ///< of these, only for clients of a high rank
    /// Connections whose request has not been read. Beyond it one of them is ended. Large, so that
    /// a crowd at the door does not push out a client before its request arrives.
    std::size_t max_handshakes = 256;
    std::size_t per_peer = 16;  ///< clients of low rank from one other computer
    /// A client of low rank that was served within this time is not ended for another one of low
    /// rank, unless it is a burden.
    std::int64_t useful_ns = 2'000'000'000;

    /// The first problem in words, or nullptr.
    [[nodiscard]] const char* problem() const noexcept;
};

/// `high`: somebody who showed the token of a rider or of an operator.
enum class Rank : std::uint8_t { low, high };

/// Which connection gets a slot, and which one is ended for it. Bookkeeping alone: no socket, no
/// clock, no thread. A service calls `arrive` for every connection that it accepts, `enter` when it
/// has read the request, `served` after each piece of work, and `leave` when a connection has
/// ended, whatever the reason.
///
/// An `Id` that is returned names a connection that the caller must end now; the caller then calls
/// `leave` for it. What is ended first, among clients of low rank:
///  1. a client that was never served and listens to nothing, the oldest first;
///  2. a client that was not served within `useful_ns` and listens to nothing;
///  3. the client that costs most, if it costs more than a rider who asks 15 times a second;
///  4. a client that listens but was not served within `useful_ns`.
/// A newcomer of low rank gets no slot when none of these exists. A newcomer of high rank then
/// replaces any client of low rank. No client of high rank is ever ended for another client.
class Slots {
  public:
    using Id = std::uint64_t;
    struct Entry {
        bool granted = false;
        bool peer_is_full = false;  ///< why not: too many clients come from this computer
        std::optional<Id> ended;    ///< end this connection
    };

    explicit Slots(const SlotLimits& limits) : limits_(limits) {}

    /// A new connection at the door. `peer`: the address of the other computer; empty for a client
    /// of this computer. Returns the connection to end when the door is full: the oldest one of the
    /// peer that has most connections at the door, never the new one.
    [[nodiscard]] std::optional<Id> arrive(Id id, std::string_view peer, std::int64_t now_ns);
    /// The request was read and is welcome: the connection becomes a client, if there is a slot.
    [[nodiscard]] Entry enter(Id id, Rank rank, std::int64_t now_ns);
    /// The client showed a token later.
    void promote(Id id) noexcept;
    /// The client was served; `cost_ns` of processor time went into it.
    void served(Id id, std::int64_t now_ns, std::int64_t cost_ns) noexcept;
    /// Whether the client is subscribed to something.
    void listens(Id id, bool listens) noexcept;
    void leave(Id id) noexcept { held_.erase(id); }

    /// Processor time of the last second or so: half of it is forgotten each second.
    [[nodiscard]] std::int64_t burden_ns(Id id, std::int64_t now_ns) const noexcept;
    [[nodiscard]] std::size_t clients() const noexcept;
    [[nodiscard]] std::size_t handshakes() const noexcept { return held_.size() - clients(); }
    [[nodiscard]] bool is_high(Id id) const noexcept;

  private:
    struct Held {
        std::string peer;
        std::int64_t since_ns = 0;  ///< arrived, became a client, or was served
        bool is_client = false;
        bool listens = false;
        bool was_served = false;
        Rank rank = Rank::low;
        std::int64_t cost_ns = 0;
        std::int64_t cost_at_ns = 0;  ///< when `cost_ns` was halved last
    };
    using Map = std::map<Id, Held>;

    [[nodiscard]] std::size_t low_clients_of(std::string_view peer) const noexcept;
    [[nodiscard]] std::optional<Id> fullest_door() const;
    [[nodiscard]] std::optional<Id> least_useful(Rank newcomer, std::int64_t now_ns) const;
    [[nodiscard]] int order_of(const Held& held, std::int64_t now_ns) const noexcept;

    SlotLimits limits_;
    Map held_;
};

}  // namespace surefoot::gate_process
