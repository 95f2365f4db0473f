# Serves the page's files from the app's assets.
.class public Lorg/alidade/page/Files;
.super Landroid/webkit/WebViewClient;

.field private final assets:Landroid/content/res/AssetManager;

.method public constructor <init>(Landroid/content/res/AssetManager;)V
    .registers 2
    invoke-direct {p0}, Landroid/webkit/WebViewClient;-><init>()V
    iput-object p1, p0, Lorg/alidade/page/Files;->assets:Landroid/content/res/AssetManager;
    return-void
.end method

.method private static isOurs(Landroid/webkit/WebResourceRequest;)Z
    .registers 3
    invoke-interface {p0}, Landroid/webkit/WebResourceRequest;->getUrl()Landroid/net/Uri;
    move-result-object v0
    invoke-virtual {v0}, Landroid/net/Uri;->getHost()Ljava/lang/String;
    move-result-object v0
    const-string v1, "alidade.invalid"
    invoke-virtual {v1, v0}, Ljava/lang/String;->equals(Ljava/lang/Object;)Z
    move-result v0
    return v0
.end method

# Blocks navigation to other pages (returns true for them).
.method public shouldOverrideUrlLoading(Landroid/webkit/WebView;Landroid/webkit/WebResourceRequest;)Z
    .registers 4
    invoke-static {p2}, Lorg/alidade/page/Files;->isOurs(Landroid/webkit/WebResourceRequest;)Z
    move-result v0
    xor-int/lit8 v0, v0, 0x1
    return v0
.end method

# Browsers require the correct MIME type for scripts and WebAssembly.
.method static typeOf(Ljava/lang/String;)Ljava/lang/String;
    .registers 5
    const-string v1, ".html text/html .txt text/plain .js text/javascript .mjs text/javascript .css text/css .svg image/svg+xml .wasm application/wasm .webmanifest application/manifest+json"
    const-string v2, " "
    invoke-virtual {v1, v2}, Ljava/lang/String;->split(Ljava/lang/String;)[Ljava/lang/String;
    move-result-object v0
    const/4 v1, 0x0
    :next
    array-length v2, v0
    if-ge v1, v2, :unknown
    aget-object v2, v0, v1
    invoke-virtual {p0, v2}, Ljava/lang/String;->endsWith(Ljava/lang/String;)Z
    move-result v2
    add-int/lit8 v3, v1, 0x1
    if-nez v2, :found
    add-int/lit8 v1, v1, 0x2
    goto :next
    :found
    aget-object v0, v0, v3
    return-object v0
    :unknown
    const-string v0, "application/octet-stream"
    return-object v0
.end method

.method public shouldInterceptRequest(Landroid/webkit/WebView;Landroid/webkit/WebResourceRequest;)Landroid/webkit/WebResourceResponse;
    .registers 12
    # Other requests go to the network, for which the app has no permission.
    invoke-static {p2}, Lorg/alidade/page/Files;->isOurs(Landroid/webkit/WebResourceRequest;)Z
    move-result v0
    if-nez v0, :ours
    const/4 v0, 0x0
    return-object v0
    :ours
    invoke-interface {p2}, Landroid/webkit/WebResourceRequest;->getUrl()Landroid/net/Uri;
    move-result-object v0
    invoke-virtual {v0}, Landroid/net/Uri;->getPath()Ljava/lang/String;
    move-result-object v7
    const-string v0, "/"
    invoke-virtual {v0, v7}, Ljava/lang/String;->equals(Ljava/lang/Object;)Z
    move-result v0
    if-eqz v0, :named
    const-string v7, "/index.html"
    :named
    # The same policy as the program's server sends (docs/guides/phone.md).
    new-instance v5, Ljava/util/HashMap;
    invoke-direct {v5}, Ljava/util/HashMap;-><init>()V
    const-string v0, "Content-Security-Policy"
    const-string v1, "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; connect-src 'self'; manifest-src 'self'"
    invoke-virtual {v5, v0, v1}, Ljava/util/HashMap;->put(Ljava/lang/Object;Ljava/lang/Object;)Ljava/lang/Object;
    :begin
    const-string v0, "page"
    invoke-virtual {v0, v7}, Ljava/lang/String;->concat(Ljava/lang/String;)Ljava/lang/String;
    move-result-object v0
    iget-object v1, p0, Lorg/alidade/page/Files;->assets:Landroid/content/res/AssetManager;
    invoke-virtual {v1, v0}, Landroid/content/res/AssetManager;->open(Ljava/lang/String;)Ljava/io/InputStream;
    move-result-object v6
    :end
    .catch Ljava/io/IOException; {:begin .. :end} :missing
    const/16 v3, 0xc8
    const-string v4, "OK"
    goto :answer
    :missing
    move-exception v0
    const/4 v0, 0x0
    new-array v0, v0, [B
    new-instance v6, Ljava/io/ByteArrayInputStream;
    invoke-direct {v6, v0}, Ljava/io/ByteArrayInputStream;-><init>([B)V
    const/16 v3, 0x194
    const-string v4, "Not Found"
    :answer
    invoke-static {v7}, Lorg/alidade/page/Files;->typeOf(Ljava/lang/String;)Ljava/lang/String;
    move-result-object v1
    const-string v2, "utf-8"
    new-instance v0, Landroid/webkit/WebResourceResponse;
    invoke-direct/range {v0 .. v6}, Landroid/webkit/WebResourceResponse;-><init>(Ljava/lang/String;Ljava/lang/String;ILjava/lang/String;Ljava/util/Map;Ljava/io/InputStream;)V
    return-object v0
.end method
