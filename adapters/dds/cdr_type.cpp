// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/dds/cdr_type.hpp"

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "lidarena/base/error.hpp"

namespace lidarena::dds {
namespace {

constexpr std::size_t kHeaderBytes = 4;  // encapsulation: two of the encoding, two of options
constexpr std::size_t kOptionsByte =
    3;  // its last two bits: bytes of padding (DDS-XTypes 7.6.3.1.2)
constexpr std::byte kPaddingMask{3};

struct CdrData : ddsi_serdata {
  std::vector<std::byte> bytes;  ///< with the header, padded to a multiple of four
  std::size_t size = 0;          ///< without the padding
  std::int64_t sequence = 0;     ///< see sequence_of()
};

const CdrData* as_cdr(const ddsi_serdata* data) { return static_cast<const CdrData*>(data); }

std::unique_ptr<CdrData> new_data(const ddsi_sertype* type, ddsi_serdata_kind kind,
                                  std::size_t size) {
  auto data = std::make_unique<CdrData>();
  ddsi_serdata_init(data.get(), type, kind);
  data->hash = type->serdata_basehash;
  data->bytes.resize((size + 3) / 4 * 4);
  data->size = size;
  return data;
}

/// Takes the padding off received data, which say in their header how much it is.
ddsi_serdata* received(std::unique_ptr<CdrData> data) {
  if (data->size >= kHeaderBytes) {
    std::byte& options = data->bytes[kOptionsByte];
    const auto padding = std::to_integer<std::size_t>(options & kPaddingMask);
    data->size = std::max(kHeaderBytes, data->size - padding);
    options &= ~kPaddingMask;
  }
  return data.release();
}

// What Cyclone DDS asks of a kind of data; the topics have no keys.

bool have_equal_keys(const ddsi_serdata*, const ddsi_serdata*) { return true; }
std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(as_cdr(data)->bytes.size());
}
void free_data(ddsi_serdata* data) { delete static_cast<CdrData*>(data); }

/// The number of the message that a fragment is a part of, from the head of the submessage that
/// brought it (DDSI-RTPS 2.3, 9.4.5.3 and 9.4.5.4); Cyclone DDS has its bytes in the host's order.
std::int64_t sequence_in(const nn_rdata* fragment) {
  Data_DataFrag_common_t head;
  std::memcpy(&head, NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_SUBMSG_OFF(fragment)),
              sizeof head);
  if (head.smhdr.submessageId != SMID_DATA && head.smhdr.submessageId != SMID_DATA_FRAG) return 0;
  return std::int64_t{head.writerSN.high} * (std::int64_t{1} << 32) +
         std::int64_t{head.writerSN.low};
}

/// Joins the received fragments, which may overlap.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                             const nn_rdata* fragment, std::size_t size) {
  if (size < kHeaderBytes) return nullptr;
  auto data = new_data(type, kind, size);
  data->sequence = sequence_in(fragment);
  std::uint32_t offset = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= offset) continue;
    const unsigned char* payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    std::memcpy(data->bytes.data() + offset, payload + (offset - fragment->min), end - offset);
    offset = fragment->maxp1;
  }
  return received(std::move(data));
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* pieces, std::size_t size) {
  auto data = new_data(type, kind, size);
  std::byte* out = data->bytes.data();
  for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
    std::memcpy(out, pieces[i].iov_base, pieces[i].iov_len);
    out += pieces[i].iov_len;
  }
  return received(std::move(data));
}

ddsi_serdata* from_key_hash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return new_data(type, SDK_KEY, 0).release();
}
ddsi_serdata* from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) { return nullptr; }

void copy_part(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, as_cdr(data)->bytes.data() + offset, size);
}
ddsi_serdata* refer_to_part(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                            ddsrt_iovec_t* part) {
  part->iov_base = const_cast<std::byte*>(as_cdr(data)->bytes.data()) + offset;
  part->iov_len = size;
  return ddsi_serdata_ref(data);
}
void release_part(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }

bool to_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  ddsi_serdata* key = new_data(data->type, SDK_KEY, 0).release();
  key->type = nullptr;
  return key;
}
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}
std::size_t print(const ddsi_sertype* type, const ddsi_serdata* data, char* text,
                  std::size_t size) {
  return static_cast<std::size_t>(
      std::max(0, std::snprintf(text, size, "%s of %u bytes", type->type_name, size_of(data))));
}
void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) { std::memset(hash, 0, sizeof *hash); }

const ddsi_serdata_ops kDataOperations = [] {
  ddsi_serdata_ops operations{};
  operations.eqkey = have_equal_keys;
  operations.get_size = size_of;
  operations.from_ser = from_fragments;
  operations.from_ser_iov = from_pieces;
  operations.from_keyhash = from_key_hash;
  operations.from_sample = from_sample;
  operations.to_ser = copy_part;
  operations.to_ser_ref = refer_to_part;
  operations.to_ser_unref = release_part;
  operations.to_sample = to_sample;
  operations.to_untyped = to_untyped;
  operations.untyped_to_sample = untyped_to_sample;
  operations.free = free_data;
  operations.print = print;
  operations.get_keyhash = key_hash;
  return operations;
}();

// What Cyclone DDS asks of a type. Samples in the form of C structures are never made.

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  std::fill_n(samples, count, nullptr);
}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
bool are_equal(const ddsi_sertype*, const ddsi_sertype*) { return true; }  // of the same name
std::uint32_t hash_of(const ddsi_sertype*) { return 0; }

const ddsi_sertype_ops kTypeOperations = [] {
  ddsi_sertype_ops operations{};
  operations.version = ddsi_sertype_v0;
  operations.free = free_type;
  operations.zero_samples = zero_samples;
  operations.realloc_samples = realloc_samples;
  operations.free_samples = free_samples;
  operations.equal = are_equal;
  operations.hash = hash_of;
  return operations;
}();

}  // namespace

CdrTopic create_cdr_topic(dds_entity_t participant, const std::string& topic_name,
                          const std::string& type_name) {
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init(type, type_name.c_str(), &kTypeOperations, &kDataOperations, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  const dds_entity_t topic =
      dds_create_topic_sertype(participant, topic_name.c_str(), &type, nullptr, nullptr, nullptr);
  if (topic < 0) {
    ddsi_sertype_unref(type);
    throw Error("topic " + topic_name + ": " + dds_strretcode(topic));
  }
  return {topic, type};
}

ddsi_serdata* make_data(const ddsi_sertype* type, dataset::Bytes message) {
  auto data = new_data(type, SDK_DATA, message.size());
  std::ranges::copy(message, data->bytes.begin());
  const std::size_t padding = data->bytes.size() - message.size();
  if (message.size() >= kHeaderBytes) data->bytes[kOptionsByte] |= std::byte(padding);
  return data.release();
}

dataset::Bytes message_of(const ddsi_serdata* data) {
  const CdrData* cdr = as_cdr(data);
  return dataset::Bytes(cdr->bytes).first(cdr->size);
}

std::int64_t sequence_of(const ddsi_serdata* data) { return as_cdr(data)->sequence; }

}  // namespace lidarena::dds
