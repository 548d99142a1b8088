// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "service/gate_process/audit/audit_record.hpp"
#include "service/gate_process/sockets/acts.hpp"

/// A log is a chain of frames (docs/reference/audit_format.md). Fields, and their sizes [bytes]:
///
///     magic+version  kind  encoding  0  stored  plain  sequence  previous  check | payload | hash
///     4              1     1         2  4       4      8         8         4     | stored  | 8
namespace surefoot::gate_process {

enum class FrameKind : std::uint8_t { file = 1, verdict = 2, gap = 3, act = 4 };
enum class FrameEncoding : std::uint8_t { plain = 0, zstd = 1 };

struct FrameHeader {
    FrameKind kind = FrameKind::file;
    FrameEncoding encoding = FrameEncoding::plain;
    std::uint32_t stored_bytes = 0;         ///< size of the payload in the file
    std::uint32_t plain_bytes = 0;          ///< size of the unpacked payload
    std::uint64_t sequence = 0;             ///< increases by one with every frame of a run
    std::uint64_t previous_hash = 0;        ///< hash of the previous frame; 0 = first of a run
    std::uint32_t version = kFrameVersion;  ///< format version of the frame
};

inline constexpr std::uint32_t kFrameMagic = 0x00414653;  // "SFA"; the last byte is the version
inline constexpr std::uint32_t kOldestFrameVersion = 2;   ///< oldest version that can be read
inline constexpr std::size_t kFrameHeaderBytes = 36;
inline constexpr std::size_t kFrameHashBytes = 8;
/// Largest size of a payload [bytes], compressed or not.
inline constexpr std::size_t kMaxPayloadBytes = kMaxRecordBytes + 65536;

/// Appends a complete frame and returns its hash. `stored`: payload in `header.encoding`.
std::uint64_t append_frame(std::string& out, const FrameHeader& header, std::string_view stored);

enum class HeaderState : std::uint8_t { sound, no_frame, other_version, damaged };
/// Parses the first kFrameHeaderBytes of a frame.
[[nodiscard]] HeaderState parse_frame_header(std::string_view bytes, FrameHeader& header) noexcept;

/// The content of the first frame of a file.
struct FileHead {
    std::uint64_t run_id = 0;  ///< id of one gate process
    std::uint64_t number = 0;  ///< number of the file in its folder
    std::uint64_t machine_hash = 0;
    Machine machine;
};
[[nodiscard]] std::string format_file_head(const FileHead& head);
[[nodiscard]] Status parse_file_head(std::string_view bytes, FileHead& head);

/// Verdicts and acts that were lost: the memory was full, or the log ended before it wrote them.
struct AuditGap {
    std::uint64_t verdicts = 0;
    std::int64_t first_ns = 0;  ///< times of the first and the last lost entry
    std::int64_t last_ns = 0;
};
[[nodiscard]] std::string format_gap(const AuditGap& gap);
[[nodiscard]] Status parse_gap(std::string_view bytes, AuditGap& gap);

/// Returns the size of an act [bytes]; its text is cut at kMaxActText_bytes.
[[nodiscard]] std::size_t act_bytes(const Act& act) noexcept;
/// Writes act_bytes(act) bytes to `out`. Allocates nothing.
void write_act(const Act& act, char* out) noexcept;
[[nodiscard]] Status parse_act(std::string_view bytes, Act& act);

/// Returns "audit-RUN-NUMBER.log": run in 16 hexadecimal, number in 8 decimal digits.
[[nodiscard]] std::string audit_file_name(std::uint64_t run_id, std::uint64_t number);
/// Parses a name of this form. Returns false for any other name.
[[nodiscard]] bool parse_audit_file_name(std::string_view name, std::uint64_t& number) noexcept;

}  // namespace surefoot::gate_process
