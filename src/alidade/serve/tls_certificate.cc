#include "alidade/serve/tls_certificate.h"

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <boost/asio/ip/address.hpp>
#include <memory>
#include <stdexcept>

namespace alidade {
namespace {

constexpr long kDay = 86400;  // seconds
constexpr long kDays = 30;

template <class T>
T* Made(T* made) {
  if (made == nullptr) throw std::runtime_error("a certificate could not be created (OpenSSL)");
  return made;
}

void Require(bool done) {
  if (!done) throw std::runtime_error("a certificate could not be created (OpenSSL)");
}

template <class Write>
std::string Pem(Write&& write) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bio(Made(BIO_new(BIO_s_mem())), BIO_free);
  Require(write(bio.get()) == 1);
  char* text = nullptr;
  const long length = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<size_t>(length)};
}

void AddExtension(X509* certificate, int which, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> extension(
      Made(X509V3_EXT_conf_nid(nullptr, &context, which, value.c_str())), X509_EXTENSION_free);
  Require(X509_add_ext(certificate, extension.get(), -1) == 1);
}

}  // namespace

TlsCertificate MakeCertificate(const std::vector<std::string>& names) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(Made(EVP_EC_gen("P-256")),
                                                                EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> x509(Made(X509_new()), X509_free);
  std::array<unsigned char, 8> noise{};
  Require(RAND_bytes(noise.data(), static_cast<int>(noise.size())) == 1);
  uint64_t serial = 1;
  for (const unsigned char byte : noise) serial = (serial << 7) ^ byte;
  Require(X509_set_version(x509.get(), 2) == 1);  // X.509 v3
  Require(ASN1_INTEGER_set_uint64(X509_get_serialNumber(x509.get()), serial >> 1) == 1);
  Made(X509_gmtime_adj(X509_getm_notBefore(x509.get()), -kDay));  // tolerates differences of clocks
  Made(X509_gmtime_adj(X509_getm_notAfter(x509.get()), kDays * kDay));
  X509_NAME* name = X509_get_subject_name(x509.get());
  const auto* title = reinterpret_cast<const unsigned char*>("Alidade");
  Require(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, title, -1, -1, 0) == 1);
  Require(X509_set_issuer_name(x509.get(), name) == 1);
  Require(X509_set_pubkey(x509.get(), key.get()) == 1);
  std::string also;
  for (const std::string& one : names) {
    boost::system::error_code no_address;
    boost::asio::ip::make_address(one, no_address);
    also += (also.empty() ? "" : ",") + std::string(no_address ? "DNS:" : "IP:") + one;
  }
  AddExtension(x509.get(), NID_basic_constraints, "critical,CA:FALSE");
  AddExtension(x509.get(), NID_ext_key_usage, "serverAuth");
  AddExtension(x509.get(), NID_subject_alt_name, also);
  Require(X509_sign(x509.get(), key.get(), EVP_sha256()) > 0);

  TlsCertificate made;
  made.certificate = Pem([&](BIO* bio) { return PEM_write_bio_X509(bio, x509.get()); });
  made.key = Pem([&](BIO* bio) {
    return PEM_write_bio_PrivateKey(bio, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  Require(X509_digest(x509.get(), EVP_sha256(), digest.data(), &length) == 1);
  for (unsigned int i = 0; i < length; ++i) {
    if (i > 0) made.fingerprint += ':';
    made.fingerprint += "0123456789ABCDEF"[digest[i] >> 4];
    made.fingerprint += "0123456789ABCDEF"[digest[i] & 15];
  }
  return made;
}

}  // namespace alidade
