// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace surefoot::gate_process {

/// Limits of the connections that a service keeps, by rank.
struct SlotLimits {
    std::size_t max_clients = 64;
    std::size_t reserved = 8;  ///< part of max_clients that is reserved for clients of high rank
    /// Limit of connections without a complete request; above it, one connection is closed. The
    /// limit is large: many new connections must not displace a client before its request arrives.
    std::size_t max_handshakes = 256;
    std::size_t per_peer = 16;  ///< most clients of low rank per other computer
    /// A low-rank client served within this time is not closed for another low-rank client, unless
    /// it needs too much processor time.
    std::int64_t useful_ns = 2'000'000'000;

    /// Returns the first problem as a message, or nullptr.
    [[nodiscard]] const char* problem() const noexcept;
};

/// `high`: the client sent the token of a rider or of an operator.
enum class Rank : std::uint8_t { low, high };

/// Decides which connection gets a slot and which connection is closed for it. Bookkeeping only: no
/// socket, clock or thread. A service calls `arrive` for every accepted connection, `enter` after
/// reading its request, and `served` after each piece of work. It calls `leave` when the connection
/// has ended for any reason.
///
/// A returned `Id` is a connection that the caller must close now, followed by `leave`. Low-rank
/// clients are closed in this order:
/// 1. a client that was never served and has no subscription, the oldest first;
/// 2. a client without subscription that was not served within `useful_ns`;
/// 3. the most expensive client, if it costs more than a rider that asks 15 times a second;
/// 4. a client with a subscription that was not served within `useful_ns`.
/// If no client fits this list, a low-rank newcomer gets no slot, and a high-rank newcomer replaces
/// any low-rank client. A high-rank client is never closed for another client.
class Slots {
  public:
    using Id = std::uint64_t;
    struct Entry {
        bool granted = false;
        bool peer_is_full = false;  ///< refused: too many clients of low rank from this peer
        std::optional<Id> ended;    ///< connection that the caller must close
    };

    explicit Slots(const SlotLimits& limits) : limits_(limits) {}

    /// Registers a new connection. `peer`: address of the other computer; empty for this computer.
    /// If too many connections wait, returns the connection to close: the oldest of the peer with
    /// the most waiting connections, never the new one.
    [[nodiscard]] std::optional<Id> arrive(Id id, std::string_view peer, std::int64_t now_ns);
    /// Makes the connection a client if a slot exists. Call it after a valid request.
    [[nodiscard]] Entry enter(Id id, Rank rank, std::int64_t now_ns);
    /// Raises the rank. Call it if the client sends its token later.
    void promote(Id id) noexcept;
    /// Records that the client was served with `cost_ns` of processor time.
    void served(Id id, std::int64_t now_ns, std::int64_t cost_ns) noexcept;
    /// Records whether the client has a subscription.
    void listens(Id id, bool listens) noexcept;
    void leave(Id id) noexcept { held_.erase(id); }

    /// Recent processor time of a client; it decays by half each second.
    [[nodiscard]] std::int64_t burden_ns(Id id, std::int64_t now_ns) const noexcept;
    [[nodiscard]] std::size_t clients() const noexcept;
    [[nodiscard]] std::size_t handshakes() const noexcept { return held_.size() - clients(); }
    [[nodiscard]] bool is_high(Id id) const noexcept;

  private:
    struct Held {
        std::string peer;
        std::int64_t since_ns = 0;  ///< last time it arrived, became a client or was served
        bool is_client = false;
        bool listens = false;
        bool was_served = false;
        Rank rank = Rank::low;
        std::int64_t cost_ns = 0;
        std::int64_t cost_at_ns = 0;  ///< time of the last halving of `cost_ns`
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
