// Browsers start no workers for pages that are opened from a file. There the search runs in a frame of the page instead.
if (location.protocol === "file:") {
  window.IFrameWorker = window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      this.frame.answer = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      const page = this.frame.contentDocument;
      page.open();
      page.write(`<script>postMessage = (data) => frameElement.answer(data)</script><script src="${url}"></script>`);
      this.ready = new Promise((resolve) => this.frame.contentWindow.addEventListener("load", resolve));
      page.close();
    }

    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
