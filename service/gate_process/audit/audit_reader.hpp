// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/audit/audit_frame.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// The first invalid position of a log. Nothing after this position was read.
struct AuditDamage {
    std::string file;
    std::uint64_t offset = 0;               ///< start of the frame in the file [bytes]
    std::optional<std::uint64_t> sequence;  ///< sequence of the frame, if its header is readable
    std::string what;

    [[nodiscard]] std::string text() const;
};

/// Summary of a log up to its end or its first damage.
struct AuditSummary {
    std::uint64_t files = 0;
    std::uint64_t bytes = 0;
    std::uint64_t runs = 0;
    std::uint64_t verdicts = 0;
    std::uint64_t gaps = 0;
    std::uint64_t lost = 0;  ///< number of verdicts and acts in gaps
    std::uint64_t acts = 0;
    /// Messages about files that end within a frame, for example after a power loss. Such an end is
    /// not damage. Nothing is lost if the run continues in another file.
    std::vector<std::string> unfinished;
    std::optional<AuditDamage> damage;
};

/// A verdict of the log and its position.
struct AuditedAt {
    const std::string& file;
    std::uint64_t offset;
    std::uint64_t sequence;
    const Machine& machine;
    const AuditRecord& record;
};

/// Checks the chain of frames through the files of a folder, in order. Accepts any bytes.
class AuditReader {
  public:
    using OnVerdict = std::function<void(const AuditedAt&)>;
    using OnAct = std::function<void(const Act&)>;
    explicit AuditReader(OnVerdict on_verdict, OnAct on_act = {});

    /// Reads the next file. Does nothing after damage was found.
    void read(std::string_view bytes, const std::string& file);
    [[nodiscard]] const AuditSummary& summary() const noexcept { return summary_; }

  private:
    struct Frame {
        FrameHeader header;
        std::string_view payload;  ///< unpacked
        std::uint64_t hash = 0;
    };
    /// The link that the next frame must continue.
    struct Link {
        std::uint64_t sequence = 0;  ///< sequence of the next frame
        std::uint64_t previous_hash = 0;
    };

    [[nodiscard]] std::optional<Frame> next_frame(std::string_view rest);
    [[nodiscard]] bool unpack(const FrameHeader& header, std::string_view stored, Frame& frame);
    [[nodiscard]] bool take(const Frame& frame);
    [[nodiscard]] bool take_file_head(const Frame& frame);
    [[nodiscard]] bool take_verdict(const Frame& frame);
    [[nodiscard]] bool take_gap(const Frame& frame);
    [[nodiscard]] bool take_act(const Frame& frame);
    [[nodiscard]] bool follows(const FrameHeader& header, const Link& link);
    void end_unfinished(std::size_t bytes, const char* how);
    /// Records the damage. Always returns false, which means "frame rejected".
    bool damaged(std::string what, std::optional<std::uint64_t> sequence = {});

    OnVerdict on_verdict_;
    OnAct on_act_;
    AuditSummary summary_;
    std::string file_;
    std::uint64_t offset_ = 0;
    std::optional<FileHead> head_;  ///< head of the last file that has a head
    Link link_;
    std::string plain_;
    AuditRecord record_;
};

/// Returns the log files of a folder in order, or the single given file.
[[nodiscard]] Result<std::vector<std::string>> audit_files_of(const std::string& path);
/// Reads audit_files_of(path). Error if a file is missing or unreadable; damage is in the summary.
[[nodiscard]] Result<AuditSummary> read_audit(const std::string& path,
                                              AuditReader::OnVerdict on_verdict,
                                              AuditReader::OnAct on_act = {});

}  // namespace surefoot::gate_process
