// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::rex_link {

/// One answer of the model gate as it was sent, before the proxy changes its bytes.
struct Said {
    bool ok = false;
    std::uint64_t nonce = 0;  ///< nonce that the gate read in the question
    std::uint64_t connection = 0;
    std::uint64_t sequence = 0;
    unsigned command = 0;
    std::int64_t decided_ns = 0;
    std::int64_t life_ns = 0;  ///< counts from decided_ns
    std::string bytes;
};

/// A gate for tests that gives random answers and remembers them. It formats and parses texts
/// itself and shares no code with the link.
class ModelGate {
  public:
    ModelGate(Rng rng, double ok_share, bool short_lives)
        : rng_(rng), ok_share_(ok_share), short_lives_(short_lives) {}

    /// Every connection gets a new number; in the worst case the numbers start again after a
    /// restart.
    [[nodiscard]] std::uint64_t connect() { return ++last_connection_; }
    void restart() {
        last_sequence_.clear();
        if (rng_.below(2) == 0) last_connection_ = 0;
    }

    /// The answer to a question that arrived on a connection.
    [[nodiscard]] Said answer(const std::string& question,
                              std::uint64_t connection,
                              std::int64_t now_ns) {
        Said said;
        said.connection = connection;
        said.decided_ns = now_ns;
        unsigned long long nonce = 0, sequence = 0, id_sequence = 0;
        unsigned id_command = 0;
        char rest = 0;
        const int read = std::sscanf(question.c_str(),
                                     R"({"op":"call_service","id":"rex:%16llx:%llu:%u",)"
                                     R"("service":"/surefoot/step","args":)"
                                     R"({"direction":%u,"sequence":%llu}%c)",
                                     &nonce,
                                     &id_sequence,
                                     &id_command,
                                     &said.command,
                                     &sequence,
                                     &rest);
        if (read != 6 || rest != '}') {
            said.bytes = R"({"op":"status","level":"error","msg":"BAD_MESSAGE"})";
            return said;
        }
        said.nonce = nonce;
        said.sequence = sequence;
        decide(said, id_sequence, id_command);
        return said;
    }

  private:
    void decide(Said& said, unsigned long long id_sequence, unsigned id_command) {
        const bool grows = said.sequence > last_sequence_[said.connection];
        if (grows) last_sequence_[said.connection] = said.sequence;
        said.ok = grows && rng_.uniform() < ok_share_;
        const bool error = !said.ok && (!grows || rng_.below(2) == 0);
        const std::int64_t life_ms = short_lives_ && rng_.below(5) == 0
                                         ? 20 + static_cast<std::int64_t>(rng_.below(200))
                                         : 300;
        said.life_ns = life_ms * 1'000'000;
        char text[640];
        std::snprintf(text,
                      sizeof(text),
                      R"({"id":"rex:%016llx:%llu:%u","op":"service_response","result":true,)"
                      R"("service":"/surefoot/step","values":{"command":%u,"connection":%llu,)"
                      R"("map_version":5,"primary":"%s","reasons":[%s],"result_code":%d,)"
                      R"("sequence":%llu,"text":"by chance","valid_for_ms":%lld,"verdict":"%s"}})",
                      static_cast<unsigned long long>(said.nonce),
                      id_sequence,
                      id_command,
                      said.command,
                      static_cast<unsigned long long>(said.connection),
                      said.ok ? "NONE" : (error ? "SEQ" : "DROP_OFF"),
                      said.ok ? "" : (error ? "\"SEQ\"" : "\"DROP_OFF\""),
                      said.ok ? 0 : (error ? -1 : 1),
                      static_cast<unsigned long long>(said.sequence),
                      static_cast<long long>(life_ms),
                      said.ok ? "OK" : (error ? "ERROR" : "NOT_TRAVERSABLE"));
        said.bytes = text;
    }

    Rng rng_;
    double ok_share_;
    bool short_lives_;
    std::uint64_t last_connection_ = 0;
    std::map<std::uint64_t, std::uint64_t> last_sequence_;  ///< by connection
};

}  // namespace surefoot::rex_link
