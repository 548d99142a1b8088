// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/snapshot_channel.hpp"

#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstring>
#include <mutex>
#include <span>
#include <type_traits>
#include <utility>

#include "service/gate_process/channel/memory_checksum.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::uint64_t kMagic = 0x4c4e484354465253;  // "SRFTCHNL"
constexpr std::uint32_t kLayout = 3;
constexpr std::uint64_t kSlots = 3;
constexpr std::size_t kPage = 4096;

/// The first bytes of the file. Each number is read and written atomically.
struct Head {
    ChannelBegin begin;
    std::uint32_t layout = kLayout;
    std::uint32_t snapshot_bytes = sizeof(grid::MapSnapshot);
    std::uint64_t writer = 0;          ///< number of the present writer; 0 while the writer starts
    std::uint64_t published = 0;       ///< number of snapshots; the newest is in slot published % 3
    std::uint64_t restart_wanted = 0;  ///< number of the writer that must restart
    std::uint64_t faults = 0;  ///< faults of the gate until an operator re-arms it; 0 = none
    std::uint64_t faults_checksum = 0;
};
static_assert(sizeof(Head) <= kPage && std::is_trivially_copyable_v<Head>);

/// A slot holds a snapshot, followed by its checksum.
constexpr std::size_t kSlotBytes =
    (sizeof(grid::MapSnapshot) + sizeof(std::uint64_t) + kPage - 1) / kPage * kPage;
constexpr std::size_t kFileBytes = kPage + kSlots * kSlotBytes;

constexpr std::size_t slot_at(std::uint64_t published) noexcept {
    return kPage + static_cast<std::size_t>(published % kSlots) * kSlotBytes;
}

/// Returns a random number. It is never 0, and it practically never repeats.
Result<std::uint64_t> new_number() {
    const auto random = new_checksum_key();
    if (!random) return random.error();
    return random->low | 1U;
}

/// The checksums of a channel include the kind of their data.
enum class Kind : std::uint64_t { snapshot = 1, faults = 2 };

std::uint64_t checksum_of(const ChecksumKey& key,
                          std::uint64_t writer,
                          std::uint64_t published,
                          const grid::MapSnapshot& map) noexcept {
    return memory_checksum(key,
                           {static_cast<std::uint64_t>(Kind::snapshot), writer, published},
                           std::span(reinterpret_cast<const unsigned char*>(&map), sizeof(map)));
}

std::uint64_t checksum_of_faults(const ChecksumKey& key, std::uint64_t bits) noexcept {
    KeyedChecksum checksum(key);
    checksum.add(static_cast<std::uint64_t>(Kind::faults));
    checksum.add(bits);
    return checksum.finish();
}

bool read_head(const ChannelFile& file, Head& head) noexcept {
    return file.read(&head, sizeof(head), 0);
}

bool is_channel(const Head& head) noexcept {
    return head.begin.magic == kMagic && head.layout == kLayout &&
           head.snapshot_bytes == sizeof(grid::MapSnapshot);
}

bool write_number(const ChannelFile& file, std::size_t offset, std::uint64_t number) noexcept {
    // Orders the earlier writes before the following reads.
    std::atomic_thread_fence(std::memory_order_seq_cst);
    return file.write(&number, sizeof(number), offset);
}

}  // namespace

struct SnapshotWriter::State {
    State(ChannelAddress its_address, ChannelFile its_file)
        : address(std::move(its_address)), file(std::move(its_file)) {}

    [[nodiscard]] Head own_head() const noexcept {
        Head head;
        head.begin = {kMagic, static_cast<std::uint64_t>(::getpid())};
        head.writer = writer;
        head.published = shown;
        return head;
    }
    /// Returns the damage of the file, or nothing if the file is intact.
    [[nodiscard]] std::optional<std::string> damage() const;
    /// Rewrites the file with the stored faults of the gate.
    [[nodiscard]] Status restore(const Head& kept);

    const ChannelAddress address;
    std::mutex mutex;  ///< needed: `publish` and `mend` run on two threads
    ChannelFile file;
    std::uint64_t writer = 0;
    std::uint64_t published = 0;
    std::uint64_t shown = 0;  ///< value of `published` in the head, or 0 if the slots are empty
    bool failed = false;      ///< true: a snapshot was not written completely
};

std::optional<std::string> SnapshotWriter::State::damage() const {
    if (!file.is_at(address.path)) return "it was deleted or replaced";
    if (file.size() < kFileBytes) return "it was cut off";
    Head head;
    const Head own = own_head();
    const bool unchanged = read_head(file, head) && is_channel(head) &&
                           head.begin.owner == own.begin.owner && head.writer == own.writer &&
                           head.published == own.published;
    if (!unchanged) return "another process has changed it";
    if (failed) return "a snapshot could not be written into it";
    return std::nullopt;
}

Status SnapshotWriter::State::restore(const Head& kept) {
    if (auto sized = file.resize(kFileBytes); !sized)
        return channel_error(address.path, sized.error().message);
    shown = 0;  // truncated data is lost
    Head head = own_head();
    head.restart_wanted = kept.restart_wanted;
    head.faults = kept.faults;
    head.faults_checksum = kept.faults_checksum;
    if (!file.write(&head, sizeof(head), 0))
        return channel_error(address.path, "it cannot be written");
    failed = false;
    return {};
}

SnapshotWriter::SnapshotWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SnapshotWriter::SnapshotWriter(SnapshotWriter&& other) noexcept = default;
SnapshotWriter::~SnapshotWriter() = default;

Result<SnapshotWriter> SnapshotWriter::create(ChannelAddress address) {
    auto file = ChannelFile::lock(address.path, kMagic);
    if (!file) return file.error();
    auto state = std::make_unique<State>(std::move(address), std::move(*file));
    const auto number = new_number();
    if (!number) return number.error();
    state->writer = *number;
    Head head;  // a new start of perception clears the faults of the gate
    head.faults_checksum = checksum_of_faults(state->address.key, 0);
    if (auto restored = state->restore(head); !restored) return restored.error();
    return SnapshotWriter(std::move(state));
}

void SnapshotWriter::begin_anew() noexcept {
    const std::scoped_lock lock(state_->mutex);
    State& s = *state_;
    write_number(s.file, offsetof(Head, writer), 0);  // readers reject the slots during the restart
    // The number only needs to differ. Without random numbers, use the next odd number.
    const auto number = new_number();
    s.writer = number ? *number : s.writer + 2;
    s.published = s.shown = 0;
    write_number(s.file, offsetof(Head, published), 0);
    write_number(s.file, offsetof(Head, writer), s.writer);
}

void SnapshotWriter::publish(const grid::MapSnapshot& map) noexcept {
    const std::scoped_lock lock(state_->mutex);
    State& s = *state_;
    const std::uint64_t number = s.published + 1;
    const std::size_t slot = slot_at(number);
    s.failed = !s.file.write(&map, sizeof(map), slot) ||
               !write_number(
                   s.file, slot + sizeof(map), checksum_of(s.address.key, s.writer, number, map));
    if (s.failed) return;
    s.published = s.shown = number;
    write_number(s.file, offsetof(Head, published), number);
}

bool SnapshotWriter::restart_wanted() const noexcept {
    const std::scoped_lock lock(state_->mutex);
    Head head;
    return read_head(state_->file, head) && head.restart_wanted == state_->writer;
}

Result<std::optional<std::string>> SnapshotWriter::mend() {
    const std::scoped_lock lock(state_->mutex);
    State& s = *state_;
    const auto damage = s.damage();
    if (!damage) return damage;
    Head kept;
    if (!read_head(s.file, kept)) {
        kept = Head{};
        kept.faults_checksum = checksum_of_faults(s.address.key, 0);
    }
    if (!s.file.is_at(s.address.path)) {
        auto file = ChannelFile::lock(s.address.path, kMagic);
        if (!file) return file.error();
        s.file = std::move(*file);
    }
    if (auto restored = s.restore(kept); !restored) return restored.error();
    return damage;
}

void SnapshotWriter::remove() noexcept {
    const std::scoped_lock lock(state_->mutex);
    if (state_->file.is_at(state_->address.path)) ::unlink(state_->address.path.c_str());
}

Result<SnapshotReader> SnapshotReader::open(ChannelAddress address) {
    auto file = ChannelFile::open(address.path);
    if (!file) return file.error();
    SnapshotReader reader(std::move(address), std::move(*file));
    Head head;
    if (reader.file_.size() < kFileBytes || !read_head(reader.file_, head) || !is_channel(head))
        return channel_error(reader.address_.path,
                             "it is not a channel of this program version; restart both programs");
    return reader;
}

Status SnapshotReader::reopen() {
    auto now = open(address_);
    if (!now) return now.error();
    file_ = std::move(now->file_);
    return {};
}

bool SnapshotReader::has_fresh() const noexcept {
    Head head;
    return read_head(file_, head) && (head.published != seen_ || head.writer != writer_);
}

bool SnapshotReader::is_whole() const noexcept {
    return file_.is_at(address_.path) && file_.size() >= kFileBytes;
}

bool SnapshotReader::is_genuine(std::uint64_t published, grid::MapSnapshot& out) const noexcept {
    if (published < seen_ || published == forged_) return false;
    const std::size_t slot = slot_at(published);
    std::uint64_t checksum = 0;
    return file_.read(&out, sizeof(out), slot) &&
           file_.read(&checksum, sizeof(checksum), slot + sizeof(out)) &&
           checksum == checksum_of(address_.key, writer_, published, out);
}

SnapshotReader::Read SnapshotReader::read(grid::MapSnapshot& out) noexcept {
    for (int attempt = 0; attempt < 3; ++attempt) {
        Head head;
        if (!is_whole() || !read_head(file_, head) || !is_channel(head)) return Read::lost;
        if (head.writer != writer_) {
            writer_ = head.writer;
            seen_ = forged_ = 0;
        }
        if (writer_ == 0 || head.published == 0) return Read::nothing;
        if (head.published == seen_) return Read::same;
        if (is_genuine(head.published, out)) {
            seen_ = head.published;
            return Read::fresh;
        }
        // The writer uses this slot again only after two more publications. So if the numbers are
        // unchanged, another process has changed the slot.
        std::atomic_thread_fence(std::memory_order_seq_cst);
        Head after;
        if (!is_whole() || !read_head(file_, after)) return Read::lost;
        if (after.writer == head.writer && after.published == head.published) {
            forged_ = head.published;
            return Read::forged;
        }
    }
    return Read::torn;
}

void SnapshotReader::keep_faults(std::uint64_t bits) noexcept {
    const std::uint64_t kept[2] = {bits, checksum_of_faults(address_.key, bits)};
    static_assert(offsetof(Head, faults_checksum) == offsetof(Head, faults) + sizeof(kept[0]));
    file_.write(kept, sizeof(kept), offsetof(Head, faults));
}

std::uint64_t SnapshotReader::kept_faults() const noexcept {
    Head head;
    if (!read_head(file_, head)) return 0;
    const bool ours = head.faults_checksum == checksum_of_faults(address_.key, head.faults);
    return ours ? head.faults : std::uint64_t{1} << 63U;
}

void SnapshotReader::want_restart() noexcept {
    Head head;
    if (read_head(file_, head)) write_number(file_, offsetof(Head, restart_wanted), head.writer);
}

}  // namespace surefoot::gate_process
