#include "alidade/serve/http_session.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <filesystem>
#include <limits>
#include <utility>

#include "alidade/serve/frame_client.h"
#include "alidade/serve/stream_client.h"

namespace alidade {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace asio = boost::asio;

constexpr uint32_t kMostHeader = 8192;             // bytes; browsers send about 1000
constexpr size_t kMostBuffered = 16384;            // bytes: a header and data sent after it
constexpr size_t kPartBytes = size_t{256} << 10;   // bytes of a file read and sent at a time
constexpr auto kLinger = std::chrono::seconds(1);  // time for the client to read the refusal
// Bytes of bodies in memory, of all connections together.
constexpr size_t kMostPosted = size_t{256} << 20;
constexpr double kSlowestBody = 1e5;  // bytes per second, of a body beyond the usual patience
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr std::string_view kNoToken =
    "the token is missing, with which the address printed by the program ends\n";
constexpr std::string_view kText = "text/plain; charset=utf-8";

std::optional<std::string_view> Only(const http::fields& fields, http::field name) {
  const auto [first, last] = fields.equal_range(name);
  if (first == last || std::next(first) != last) return std::nullopt;
  return std::string_view(first->value().data(), first->value().size());
}

}  // namespace

HttpSession::HttpSession(asio::ip::tcp::socket socket, ServerCore& core)
    : core_(core),
      stream_(std::move(socket)),
      buffer_(kMostBuffered),
      posted_bytes_(core.posted_bytes),
      active_(std::chrono::steady_clock::now()),
      accepted_(active_) {}

HttpSession::~HttpSession() { Release(); }

void HttpSession::Start() { Read(); }

Site HttpSession::site() const {
  const ServeTask& task = core_.task;
  return task.phone ? Site::kPhone : task.posts != nullptr ? Site::kPost : Site::kViewer;
}

void HttpSession::Close() { stream_.close(); }

void HttpSession::Wake() { Wake(core_.task.settings.patience); }

void HttpSession::Wake(double seconds) {
  active_ = std::chrono::steady_clock::now();
  stream_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds)));
}

double HttpSession::Age() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - accepted_).count();
}

void HttpSession::Read() {
  parser_.emplace();
  parser_->header_limit(kMostHeader);
  parser_->body_limit(0);
  if (admitted_)
    Wake();
  else
    Wake(core_.task.settings.ArrivalLimit());
  if (core_.task.posts != nullptr) {
    // Only the head is read with this parser; OnPostHead() looks at the body's length. Boost 1.74
    // takes boost::none for 0.
    parser_->body_limit(std::numeric_limits<uint64_t>::max());
    return http::async_read_header(stream_, buffer_, *parser_,
                                   [self = shared_from_this()](beast::error_code error, size_t) {
                                     if (error) return self->OnBadRequest(error);
                                     self->OnHead();
                                   });
  }
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](beast::error_code error, size_t) {
                     if (error) return self->OnBadRequest(error);
                     self->OnRequest();
                   });
}

void HttpSession::OnHead() {
  if (parser_->get().method() == http::verb::post) return OnPostHead();
  if (parser_->is_done()) return OnRequest();
  keep_alive_ = false;
  head_only_ = false;
  Send(413, kText, "only a POST may have a body\n");
}

void HttpSession::OnPostHead() {
  const Request& request = parser_->get();
  keep_alive_ = false;  // unless the whole body was read
  head_only_ = false;
  if (!Admit(request)) return;
  const std::string_view target(request.target().data(), request.target().size());
  const PostHost& posts = *core_.task.posts;
  if (PathOf(target) != posts.path()) {
    text_ = "pictures are sent to " + std::string(posts.path()) + "\n";
    return Send(404, kText, text_);
  }
  if (!core_.gate->HasToken(target)) return Send(403, kText, kNoToken);
  admitted_ = true;
  const auto length = parser_->content_length();
  if (!length) return Send(411, kText, "the request must tell its Content-Length\n");
  if (*length > posts.most_bytes()) {
    text_ = "a picture must have at most " + std::to_string(posts.most_bytes() >> 20) + " MiB\n";
    return Send(413, kText, text_);
  }
  if (*posted_bytes_ + *length > kMostPosted)
    return Send(503, kText, "too many pictures at a time; try again\n");
  reserved_ = *length;
  *posted_bytes_ += reserved_;
  const auto expects = Only(request, http::field::expect);
  if (!expects || !beast::iequals({expects->data(), expects->size()}, "100-continue"))
    return ReadBody();
  Wake();
  asio::async_write(stream_, asio::buffer(kContinue),
                    [self = shared_from_this()](beast::error_code error, size_t) {
                      if (error) return self->Close();
                      self->ReadBody();
                    });
}

void HttpSession::ReadBody() {
  post_.emplace(std::move(*parser_));
  post_->body_limit(core_.task.posts->most_bytes());
  Wake(core_.task.settings.patience + static_cast<double>(reserved_) / kSlowestBody);
  http::async_read(stream_, buffer_, *post_,
                   [self = shared_from_this()](beast::error_code error, size_t) {
                     if (error) return self->OnBadRequest(error);
                     self->OnPost();
                   });
}

void HttpSession::OnPost() {
  auto& request = post_->get();
  keep_alive_ = request.keep_alive();
  const std::string_view target(request.target().data(), request.target().size());
  const size_t mark = target.find('?');
  PostRequest post;
  if (mark != std::string_view::npos) post.query = target.substr(mark + 1);
  post.type = std::string(Only(request, http::field::content_type).value_or(""));
  post.body = std::move(request.body());
  post_.reset();
  const uint64_t number = ++core_.last_request;
  stream_.expires_never();
  core_.waiting[number] = shared_from_this();
  ServerCore* const core = &core_;
  const auto reply = [core, number, box = core_.box](PostAnswer answer) {
    const std::lock_guard lock(box->mutex);
    if (box->io == nullptr) return;
    asio::post(*box->io, [core, number, answer = std::move(answer)] {
      const auto found = core->waiting.find(number);
      if (found == core->waiting.end()) return;  // the server is ending
      const std::shared_ptr<HttpSession> session = std::move(found->second);
      core->waiting.erase(found);
      session->OnAnswer(answer);
    });
  };
  if (core_.task.posts->Take(std::move(post), reply)) return;
  core_.waiting.erase(number);
  Release();
  Send(503, kText, "too many pictures at a time; try again\n");
}

void HttpSession::OnAnswer(const PostAnswer& answer) {
  Release();
  text_ = answer.json;
  Send(answer.status, "application/json", text_);
}

void HttpSession::Release() { *posted_bytes_ -= std::exchange(reserved_, 0); }

void HttpSession::OnBadRequest(beast::error_code error) {
  keep_alive_ = false;
  head_only_ = false;
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return Send(431, kText, "the request is too long\n");
  if (error == http::error::body_limit || error == http::error::unexpected_body)
    return Send(413, kText, "requests must not have a body\n");
  const bool malformed = error.category() == make_error_code(http::error::bad_method).category() &&
                         error != http::error::end_of_stream &&
                         error != http::error::partial_message;
  if (malformed) return Send(400, kText, "not an HTTP request\n");
  Close();  // the client disconnected or timed out
}

std::string HttpSession::Refusal(const Request& request) const {
  beast::error_code error;
  const auto local = stream_.socket().local_endpoint(error);
  if (error) return "gone";
  const std::string address = UrlAddress(local.address());
  Caller caller;
  caller.host = Only(request, http::field::host);
  if (request.count(http::field::origin) > 0)
    caller.origin = Only(request, http::field::origin).value_or("");
  caller.target = {request.target().data(), request.target().size()};
  caller.local = address;
  caller.loopback = address == "[::1]" || address.rfind("127.", 0) == 0;
  return core_.gate->Refusal(caller);
}

bool HttpSession::Admit(const Request& request) {
  const std::string refusal = Refusal(request);
  if (refusal.empty()) return true;
  text_ = refusal + "\n";
  keep_alive_ = false;
  Send(403, kText, text_);
  return false;
}

void HttpSession::OnRequest() {
  const Request& request = parser_->get();
  keep_alive_ = request.keep_alive();
  head_only_ = request.method() == http::verb::head;
  if (!Admit(request)) return;
  const std::string_view target(request.target().data(), request.target().size());
  const std::string_view path = PathOf(target);
  const ServeTask& task = core_.task;
  if (task.posts != nullptr && path == task.posts->path())
    return Send(405, kText, "send a picture by POST, as curl --data-binary @photo.jpg does\n");
  if (!head_only_ && request.method() != http::verb::get)
    return Send(405, kText, "only GET and HEAD are allowed\n");
  const bool is_stream = path == "/stream" && task.hub != nullptr;
  const bool is_frames = path == "/frames" && task.frames != nullptr;
  const bool is_file = path == "/run.stream" && !task.replay_path.empty();
  // Compiled-in files are public; the page requests them without the token.
  const bool is_own = path == "/" || path == "/index.html" || path == "/info.json" ||
                      (path == "/map.json" && task.posts != nullptr);
  const bool is_cloud = path == "/semidense.ply" && !task.cloud_path.empty();
  const bool is_mesh = path == "/mesh.ply" && !task.mesh_path.empty();
  if (is_stream || is_frames || is_file || is_cloud || is_mesh || is_own) {
    if (!core_.gate->HasToken(target)) return Send(403, kText, kNoToken);
    admitted_ = true;
  }
  // Browsers use several connections, some of them only for files that need no token.
  if (!admitted_ && Age() > core_.task.settings.ArrivalLimit()) keep_alive_ = false;
  if (is_stream) return Upgrade();
  if (is_frames) return UpgradeFrames();
  if (is_file) return SendFile(task.replay_path, "application/octet-stream");
  if (is_cloud) return SendFile(task.cloud_path, "application/octet-stream");
  if (is_mesh) return SendFile(task.mesh_path, "application/octet-stream");
  if (path == "/info.json" || (path == "/map.json" && task.posts != nullptr))
    return Send(200, "application/json", task.info);
  const auto accepted = Only(request, http::field::accept_encoding);
  if (const std::string core = FindCore(path, task.core_folder); !core.empty())
    return SendFile(core, TypeOf(core));
  const auto& files = site() == Site::kPhone  ? PhoneFiles()
                      : site() == Site::kPost ? PostFiles()
                                              : PageFiles();
  const auto page = FindPage(path, files, AcceptsGzip(accepted.value_or("")));
  if (!page) return Send(404, kText, "there is no such page\n");
  Send(200, page->type, page->bytes, page->gzipped);
}

void HttpSession::Upgrade() {
  const Request& request = parser_->get();
  if (!beast::websocket::is_upgrade(request) || buffer_.size() > 0)
    return Send(400, kText, "this address is a WebSocket\n");
  if (!core_.MayJoin()) return Send(503, kText, "too many viewers\n");
  auto client = std::make_shared<StreamClient>(std::move(stream_), core_.io, *core_.task.hub,
                                               core_.task.settings, core_.viewers);
  core_.clients.push_back(client);
  client->Start(request);
}

void HttpSession::UpgradeFrames() {
  const Request& request = parser_->get();
  if (!beast::websocket::is_upgrade(request) || buffer_.size() > 0)
    return Send(400, kText, "this address is a WebSocket\n");
  if (!core_.MayJoin()) return Send(503, kText, "too many pages\n");
  auto client = std::make_shared<FrameClient>(std::move(stream_), core_.io, *core_.task.frames,
                                              core_.task.settings, core_.warned_of_page);
  core_.pages.push_back(client);
  client->Start(request);
}

void HttpSession::Send(int status, std::string_view type, std::string_view body, bool gzipped) {
  head_ = ResponseHead(status, type, body.size(), keep_alive_, gzipped, site());
  Wake();
  const std::array<asio::const_buffer, 2> buffers = {
      asio::buffer(head_), asio::buffer(body.data(), head_only_ ? 0 : body.size())};
  asio::async_write(stream_, buffers, [self = shared_from_this()](beast::error_code error, size_t) {
    self->Sent(error);
  });
}

void HttpSession::SendFile(const std::string& path, std::string_view type) {
  std::error_code error;
  file_left_ = std::filesystem::file_size(path, error);
  file_.open(path, std::ios::binary);
  if (error || !file_) return Send(404, kText, "the file no longer exists\n");
  head_ = ResponseHead(200, type, file_left_, keep_alive_, false, site());
  if (head_only_) file_left_ = 0;
  Wake();
  asio::async_write(stream_, asio::buffer(head_),
                    [self = shared_from_this()](beast::error_code failed, size_t) {
                      if (failed) return self->Close();
                      self->SendPart();
                    });
}

void HttpSession::SendPart() {
  if (file_left_ == 0) {
    file_.close();
    part_ = {};
    return Sent({});
  }
  part_.resize(std::min<uint64_t>(kPartBytes, file_left_));
  if (!file_.read(part_.data(), static_cast<std::streamsize>(part_.size())))
    return Close();  // the file was truncated meanwhile
  file_left_ -= part_.size();
  Wake();
  asio::async_write(stream_, asio::buffer(part_),
                    [self = shared_from_this()](beast::error_code error, size_t) {
                      if (error) return self->Close();
                      self->SendPart();
                    });
}

void HttpSession::Sent(beast::error_code error) {
  if (error) return Close();
  if (keep_alive_) return Read();
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
  stream_.expires_after(kLinger);
  Linger();
}

// Reads and discards input, because closing a socket with unread input would discard the response.
void HttpSession::Linger() {
  stream_.async_read_some(asio::buffer(scratch_),
                          [self = shared_from_this()](beast::error_code error, size_t) {
                            if (error) return self->Close();
                            self->Linger();
                          });
}

}  // namespace alidade
